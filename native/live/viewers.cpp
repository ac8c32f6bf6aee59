// SPDX-License-Identifier: Apache-2.0
#include "live/viewers.h"

namespace fourdvt::live {

void Viewers::add(const std::shared_ptr<Connection>& connection, const std::string& manifest) {
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  connection->send(std::make_shared<const std::vector<uint8_t>>(manifest.begin(), manifest.end()), true);
  viewers_[connection.get()].connection = connection;
}

void Viewers::remove(const Connection* connection) {
  const std::lock_guard lock(mutex_);
  viewers_.erase(connection);
}

void Viewers::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  viewers_.clear();
}

void Viewers::send(const Bytes& frame, bool key) {
  const std::lock_guard lock(mutex_);
  for (auto& [id, viewer] : viewers_) {
    Connection& connection = *viewer.connection;
    if (connection.queuedMessages() > kMostWaiting || connection.queuedBytes() > kMostWaitingBytes)
      viewer.needs_key = true;
    else if (key)
      viewer.needs_key = false;
    if (viewer.needs_key) {
      ++skipped_;
      continue;
    }
    connection.send(frame);
    bytes_ += frame->size();
  }
  const auto now = Clock::now();
  const double elapsed_s = std::chrono::duration<double>(now - since_).count();
  if (elapsed_s < 1) return;
  bytes_per_s_ = double(bytes_ - bytes_before_) / elapsed_s;
  bytes_before_ = bytes_;
  since_ = now;
}

Viewers::Status Viewers::status() const {
  const std::lock_guard lock(mutex_);
  return {viewers_.size(), skipped_, viewers_.empty() ? 0 : bytes_per_s_};
}

}  // namespace fourdvt::live
