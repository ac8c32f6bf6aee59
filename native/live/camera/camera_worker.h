// SPDX-License-Identifier: Apache-2.0
// One camera at work: opens its source, keys each picture, simplifies its outline and hands both on as a message. Works
// on a thread of its own; when keying is slower than the source, pictures are left out, the latest is taken. Does NOT
// know sockets.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "live/protocol/camera_messages.h"
#include "live/rig/rig.h"

namespace fourdvt::live {

struct WorkerStats {
  uint64_t pictures = 0, left_out = 0;  // left out: the source was faster than keying
  double keyed_ms = 0;                  // median of the last second
};

class CameraWorker {
 public:
  // Errors: those of the source (FileMissing, FileUnreadable), of the plates, and FrameSize.
  static Result<std::unique_ptr<CameraWorker>> start(const Rig& rig, const std::string& camera,
                                                     std::function<void(CameraPicture)> on_picture,
                                                     std::function<void(const Error&)> on_end);
  virtual ~CameraWorker() = default;  // joins the thread
  virtual void set(const CameraSettings& settings) = 0;
  virtual WorkerStats stats() const = 0;
  virtual Hello hello() const = 0;
};

}  // namespace fourdvt::live
