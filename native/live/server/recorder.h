// SPDX-License-Identifier: Apache-2.0
// Writes what comes in as a capture folder that reconstruct and bake read: takes of instants in which all cameras were
// there, with the live mattes. Works on a thread of its own and never blocks its caller. Does NOT write surfaces.
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
  static constexpr uint32_t kFewestFrames = 5;  // shorter takes are dropped
  static constexpr size_t kMostWaiting = 64;    // instants: beyond them the take ends

  // on_warning: called on the recorder's thread and on add's. Errors: WriteFailed (the folder cannot be written, or
  // holds something), InvalidArgument (cameras of odd sizes), and those of the plates.
  static Result<std::unique_ptr<Recorder>> start(const Rig& rig, const std::string& folder,
                                                 std::function<void(const std::string&)> on_warning);
  virtual ~Recorder() = default;  // writes what waits, ends the take
  // Instants, ascending; a gap, or a camera that is missing, ends the take.
  virtual void add(const Instant& instant) = 0;
  virtual uint64_t recorded() const = 0;  // frames of videos
};

}  // namespace fourdvt::live
