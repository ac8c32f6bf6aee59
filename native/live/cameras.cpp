// SPDX-License-Identifier: Apache-2.0
#include "live/cameras.h"

#include "live/service.h"

namespace fourdvt::live {
namespace {

constexpr int kTicksPerSecond = 5, kQuickQuestions = 5;  // clock questions to a new camera, one per tick

Bytes written(const ToCamera& message) { return std::make_shared<std::vector<uint8_t>>(writeToCamera(message)); }

std::string sizeText(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

Cameras::Cameras(const Rig& rig, Pipeline& pipeline, std::vector<bool> is_local, double hello_s)
    : rig_(rig),
      pipeline_(pipeline),
      is_local_(std::move(is_local)),
      hello_s_(hello_s),
      by_camera_(rig.cameras.size()) {}

void Cameras::add(const std::shared_ptr<Connection>& connection) { peers_[connection]; }

void Cameras::remove(const std::shared_ptr<Connection>& connection) {
  const auto found = peers_.find(connection);
  if (found == peers_.end()) return;
  const int camera = found->second.camera;
  peers_.erase(found);
  if (camera < 0) return;
  {
    const std::lock_guard lock(mutex_);
    auto& present = by_camera_[static_cast<size_t>(camera)];
    if (present != connection) return;  // replaced by another connection
    present.reset();
  }
  pipeline_.setConnected(static_cast<size_t>(camera), false);
}

Status Cameras::receive(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) {
  const auto found = peers_.find(connection);
  if (found == peers_.end()) return {};
  Peer& peer = found->second;
  if (text) return Error{ErrorId::StreamInvalid, "live camera: text in place of a message"};
  FOURDVT_ASSIGN(FromCamera message, readFromCamera(bytes));
  if (const auto* first = std::get_if<Hello>(&message)) return hello(connection, peer, *first);
  if (peer.camera < 0) return Error{ErrorId::StreamInvalid, "live camera: the first message is no Hello"};
  const auto camera = static_cast<size_t>(peer.camera);
  const int64_t now_us = serverNow_us();
  if (const auto* answer = std::get_if<ClockAnswer>(&message))
    pipeline_.onClock(camera, *answer, now_us);
  else
    pipeline_.onPicture(camera, std::move(std::get<CameraPicture>(message)), bytes.size(), now_us);
  return {};
}

Status Cameras::hello(const std::shared_ptr<Connection>& connection, Peer& peer, const Hello& hello) {
  if (peer.camera >= 0) return Error{ErrorId::StreamInvalid, "live camera: a second Hello"};
  size_t camera = 0;
  while (camera < rig_.cameras.size() && rig_.cameras[camera].camera.pinhole.name != hello.camera) ++camera;
  const std::string who = "live camera \"" + hello.camera + "\"";
  if (camera == rig_.cameras.size())
    return Error{ErrorId::InvalidArgument, who + " is not in the server's rig; use the same RIG.json on all sides"};
  const PinholeCamera& pinhole = rig_.cameras[camera].camera.pinhole;
  if (hello.width != pinhole.width || hello.height != pinhole.height)
    return Error{ErrorId::FrameSize, who + " has pictures of " + sizeText(hello.width, hello.height) +
                                         ", the server's rig says " + sizeText(pinhole.width, pinhole.height) +
                                         "; use the same RIG.json on all sides"};
  if (is_local_[camera])
    return Error{ErrorId::InvalidArgument, who +
                                               " is read by the server itself; start it with --no-local, or take the "
                                               "camera's source out of its RIG.json"};
  peer = {static_cast<int>(camera), 0};
  std::shared_ptr<Connection> before;
  {
    const std::lock_guard lock(mutex_);
    before = std::exchange(by_camera_[camera], connection);
  }
  if (before) before->close(kCloseReplaced, "another process sends this camera's pictures");
  pipeline_.setConnected(camera, true);
  connection->send(written(pipeline_.settings(camera)));
  connection->send(written(ClockQuestion{serverNow_us()}));
  return {};
}

void Cameras::tick() {
  for (auto& entry : peers_) {
    Connection& connection = *entry.first;
    Peer& peer = entry.second;
    ++peer.ticks;
    if (peer.camera < 0) {
      if (peer.ticks > hello_s_ * kTicksPerSecond) connection.close(kCloseInvalid, "live camera: no Hello came");
    } else if (peer.ticks < kQuickQuestions || peer.ticks % kTicksPerSecond == 0) {
      connection.send(written(ClockQuestion{serverNow_us()}));
    }
  }
}

void Cameras::set(size_t camera, const CameraSettings& settings) {
  const std::lock_guard lock(mutex_);
  if (by_camera_[camera]) by_camera_[camera]->send(written(settings));
}

}  // namespace fourdvt::live
