// SPDX-License-Identifier: Apache-2.0
#include "live/sources.h"

#include <chrono>

namespace fourdvt::live {
namespace {

constexpr auto kReopenPause = std::chrono::seconds(2);

}  // namespace

int64_t serverNow_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

Sources::Sources(const Rig& rig, StartWorker start, Pipeline& pipeline, SayLine say)
    : rig_(rig), start_(std::move(start)), pipeline_(pipeline), say_(std::move(say)), sources_(rig.cameras.size()) {}

Sources::~Sources() {
  std::vector<Source> sources;
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    sources.swap(sources_);
  }
}  // workers end here, without the lock

Status Sources::open() {
  for (size_t camera = 0; camera < sources_.size(); ++camera)
    if (has(camera)) FOURDVT_TRY(open(camera));
  thread_ = std::thread([this] { reopen(); });
  return {};
}

Status Sources::open(size_t camera) {
  const std::string& name = rig_.cameras[camera].camera.pinhole.name;
  pipeline_.setConnected(camera, true);
  const int64_t now_us = serverNow_us();
  pipeline_.onClock(camera, {now_us, now_us}, now_us);
  auto started = start_(
      rig_, name,
      [this, camera](CameraPicture picture) {
        const size_t bytes = writeFromCamera(picture).size();
        pipeline_.onPicture(camera, std::move(picture), bytes, serverNow_us());
      },
      [this, camera, name](const Error& error) {
        pipeline_.setConnected(camera, false);
        say_("camera " + name + ": " + error.message);
        const std::lock_guard lock(mutex_);
        if (camera < sources_.size()) sources_[camera].has_ended = true;
        changed_.notify_all();
      });
  if (!started.ok()) {
    pipeline_.setConnected(camera, false);
    return started.error();
  }
  started.value()->set(pipeline_.settings(camera));
  const std::lock_guard lock(mutex_);
  sources_[camera].worker = started.take();
  return {};
}

void Sources::reopen() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kReopenPause, [&] { return is_stopping_; })) {
    for (size_t camera = 0; camera < sources_.size() && !is_stopping_; ++camera) {
      if (!sources_[camera].has_ended) continue;
      auto ended = std::move(sources_[camera].worker);
      sources_[camera].has_ended = false;
      lock.unlock();
      ended.reset();
      const bool is_open = open(camera).ok();
      lock.lock();
      if (!is_open) sources_[camera].has_ended = true;
    }
  }
}

void Sources::set(size_t camera, const CameraSettings& settings) {
  std::shared_ptr<CameraWorker> worker;
  {
    const std::lock_guard lock(mutex_);
    if (camera < sources_.size()) worker = sources_[camera].worker;
  }
  if (worker) worker->set(settings);
}

void Sources::tellClock() {
  const int64_t now_us = serverNow_us();
  for (size_t camera = 0; camera < rig_.cameras.size(); ++camera)
    if (has(camera)) pipeline_.onClock(camera, {now_us, now_us}, now_us);
}

}  // namespace fourdvt::live
