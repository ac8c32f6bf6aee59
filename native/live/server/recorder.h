// SPDX-License-Identifier: Apache-2.0
// Recording of a live stage as a capture folder for reconstruct and bake: takes of complete instants, with the live
// mattes but without surfaces. Runs on a thread of its own and never blocks its caller.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "live/rig/rig.h"
#include "live/server/instants.h"

namespace fourdvt::live {

class Recorder {
 public:
  static constexpr uint32_t kMinFrames = 5;  // shorter takes are dropped
  static constexpr size_t kMaxWaiting = 64;  // maximum queue of instants, above which the take ends

  // on_warning: called on the recorder's thread and on that of add(). Errors: WriteFailed (the folder cannot be
  // written, or is not empty), InvalidArgument (cameras of odd sizes), and those of the plates.
  static Result<std::unique_ptr<Recorder>> start(const Rig& rig, const std::string& folder,
                                                 std::function<void(const std::string&)> on_warning);
  virtual ~Recorder() = default;  // writes what is queued, ends the take
  // Appends an instant, in ascending order; a gap or a missing camera ends the take.
  virtual void add(const Instant& instant) = 0;
  virtual uint64_t recorded() const = 0;  // number of video frames
};

}  // namespace fourdvt::live
