// SPDX-License-Identifier: Apache-2.0
// Two threads: one reads the source and stores its latest picture, the other keys it.
#include "live/camera/camera_worker.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "base/robust.h"
#include "capture/undistort.h"
#include "live/camera/keyer.h"
#include "live/camera/outline_message.h"
#include "live/camera/source.h"

namespace fourdvt::live {
namespace {

using Clock = std::chrono::steady_clock;

class ThreadedWorker final : public CameraWorker {
 public:
  ThreadedWorker(const capture::CaptureCamera& camera, std::function<void(CameraPicture)> on_picture,
                 std::function<void(const Error&)> on_end)
      : camera_(camera), undistorter_(camera), on_picture_(std::move(on_picture)), on_end_(std::move(on_end)) {}

  ~ThreadedWorker() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    if (reader_.joinable()) reader_.join();
    if (keying_.joinable()) keying_.join();
  }

  Status start(const Rig& rig, const RigCamera& camera) {
    FOURDVT_ASSIGN(auto plates, readRigPlates(rig, camera,
                                              "no readable picture of the empty stage; take one, or correct "
                                              "\"background\" in " +
                                                  rig.path));
    for (Image& plate : plates) plate = undistorter_.apply(std::move(plate), capture::LensFilter::Fast);
    FOURDVT_ASSIGN(keyer_, Keyer::create(plates));
    if (camera_.distortion.any())
      reach_ = undistorter_.apply(Image(camera_.pinhole.width, camera_.pinhole.height, 1, 255));
    FOURDVT_ASSIGN(source_, Source::open(rig, camera, stop_));
    reader_ = std::thread([this] { readPictures(); });
    keying_ = std::thread([this] { keyPictures(); });
    return {};
  }

  void set(const CameraSettings& settings) override {
    const std::lock_guard lock(mutex_);
    settings_ = settings;
  }

  WorkerStats stats() const override {
    const std::lock_guard lock(mutex_);
    WorkerStats out = stats_;
    std::vector<double> recent;
    for (const auto& [when, ms] : keyed_)
      if (Clock::now() - when <= std::chrono::seconds(1)) recent.push_back(ms);
    out.keyed_ms = median(std::move(recent), out.keyed_ms);
    return out;
  }

  Hello hello() const override { return {camera_.pinhole.name, camera_.pinhole.width, camera_.pinhole.height}; }

 private:
  void readPictures() {
    SourcePicture picture;
    while (!stop_) {
      const Result<bool> read = source_->next(picture);
      if (!read.ok()) {
        if (!stop_) on_end_(read.error());
        return;
      }
      if (!read.value()) return;
      {
        const std::lock_guard lock(mutex_);
        std::swap(latest_, picture);
        stats_.left_out += waiting_;
        waiting_ = true;
      }
      changed_.notify_all();
    }
  }

  void keyPictures() {
    SourcePicture picture;
    while (true) {
      CameraSettings settings;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return waiting_ || stop_; });
        if (stop_) return;
        std::swap(latest_, picture);
        waiting_ = false;
        settings = settings_;
      }
      auto message = keyed(picture, settings);
      if (!message.ok()) return on_end_(message.error());
      on_picture_(message.take());
    }
  }

  Result<CameraPicture> keyed(SourcePicture& picture, const CameraSettings& settings) {
    const auto begin = Clock::now();
    if (!reach_.empty()) picture.rgb = undistorter_.apply(std::move(picture.rgb), capture::LensFilter::Fast);
    FOURDVT_ASSIGN(const Image* key, keyer_->key(picture.rgb));
    coverage_ = *key;
    keepRegion(settings.region, coverage_);
    CameraPicture out;
    out.crop = cropOf(coverage_, settings.region);
    hideUnseen();
    out.rings = ringsOf(coverage_, settings.tolerance_px);
    const std::chrono::duration<double, std::milli> taken = Clock::now() - begin;
    out.keyed_us = uint32_t(1e3 * taken.count());
    out.captured_us = picture.captured_us;
    if (out.crop.width > 0) out.jpeg = jpegOf(picture.rgb, out.crop, settings.jpeg_quality);
    const std::lock_guard lock(mutex_);
    out.number = uint32_t(++stats_.pictures);
    keyed_.emplace_back(Clock::now(), taken.count());
    while (Clock::now() - keyed_.front().first > std::chrono::seconds(1)) keyed_.pop_front();
    return out;
  }

  // Marks pixels outside the filmed picture as performer, so that they carve nothing.
  void hideUnseen() {
    for (size_t i = 0; i < reach_.pixels.size(); ++i)
      coverage_.pixels[i] = std::max(coverage_.pixels[i], uint8_t(255 - reach_.pixels[i]));
  }

  const capture::CaptureCamera camera_;
  const capture::Undistorter undistorter_;
  const std::function<void(CameraPicture)> on_picture_;
  const std::function<void(const Error&)> on_end_;
  Image reach_;  // 255 inside the filmed picture; empty without distortion
  std::unique_ptr<Keyer> keyer_;
  std::unique_ptr<Source> source_;
  Image coverage_;

  mutable std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::atomic<bool> stop_ = false;
  SourcePicture latest_;
  bool waiting_ = false;  // latest_ is not taken yet
  CameraSettings settings_;
  WorkerStats stats_;
  std::deque<std::pair<Clock::time_point, double>> keyed_;  // time of completion, duration in ms
  std::thread reader_, keying_;
};

}  // namespace

Result<std::unique_ptr<CameraWorker>> CameraWorker::start(const Rig& rig, const std::string& camera,
                                                          std::function<void(CameraPicture)> on_picture,
                                                          std::function<void(const Error&)> on_end) {
  const RigCamera* found = rig.find(camera);
  if (!found)
    return Error{ErrorId::InvalidArgument, rig.path + ": no camera \"" + camera + "\"; choose one of its \"cameras\""};
  auto worker = std::make_unique<ThreadedWorker>(found->camera, std::move(on_picture), std::move(on_end));
  FOURDVT_TRY(worker->start(rig, *found));
  return std::unique_ptr<CameraWorker>(std::move(worker));
}

}  // namespace fourdvt::live
