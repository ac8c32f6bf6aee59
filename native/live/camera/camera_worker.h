// SPDX-License-Identifier: Apache-2.0
// Processing of one camera: opens its source, keys each picture, simplifies its outline and passes both on as a
// message. Runs on a thread of its own; if keying is slower than the source, the latest picture is keyed and older ones
// are dropped. Has no sockets.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "live/protocol/camera_messages.h"
#include "live/rig/rig.h"

namespace fourdvt::live {

struct WorkerStats {
  uint64_t pictures = 0, left_out = 0;  // left_out: pictures dropped because keying was slower than the source
  double keyed_ms = 0;                  // median over the last second
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
