// SPDX-License-Identifier: Apache-2.0
#include "live/viewers.h"

namespace fourdvt::live {

void Viewers::add(const std::shared_ptr<Connection>& connection, const std::string& manifest) {
  const std::lock_guard lock(mutex_);
  connection->send(std::make_shared<std::vector<uint8_t>>(manifest.begin(), manifest.end()), true);
  viewers_[connection];
}

void Viewers::remove(const std::shared_ptr<Connection>& connection) {
  const std::lock_guard lock(mutex_);
  viewers_.erase(connection);
}

void Viewers::send(const Bytes& frame, bool key) {
  const std::lock_guard lock(mutex_);
  for (auto& entry : viewers_) {
    Connection& connection = *entry.first;
    Viewer& viewer = entry.second;
    const bool is_behind =
        connection.queuedMessages() > kMaxBehindMessages || connection.queuedBytes() > kMaxBehindBytes;
    viewer.waits_for_key = is_behind || (viewer.waits_for_key && !key);
    if (viewer.waits_for_key) {
      frames_skipped_ += viewer.has_had_frames;  // frames before the first key do not count as skipped
      continue;
    }
    viewer.has_had_frames = true;
    bytes_ += frame->size();
    connection.send(frame);
  }
}

ViewerStatus Viewers::status() {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - measured_).count();
  if (passed_s >= 0.9) {
    bytes_per_s_ = static_cast<double>(bytes_) / passed_s;
    bytes_ = 0;
    measured_ = now;
  }
  return {viewers_.size(), frames_skipped_, bytes_per_s_};
}

}  // namespace fourdvt::live
