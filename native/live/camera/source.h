// SPDX-License-Identifier: Apache-2.0
// Pictures of one camera as time goes by, as its lens films them. A file is played in a loop, locked to the clock of
// the machine, so that all processes of a stage show the same moment. Does NOT key.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/image.h"
#include "base/result.h"
#include "live/rig/rig.h"

namespace fourdvt::live {

int64_t systemNow_us();  // since 1970

// A file's pictures by the clock: slot k begins k / fps seconds after 1970 and shows picture k modulo their number.
int64_t slotAt(int64_t now_us, double fps);
int64_t slotBegin_us(int64_t slot, double fps);

struct SourcePicture {
  Image rgb;
  int64_t captured_us = 0;  // of a file: its slot's begin; else the device's stamp, or when the picture arrived
};

class Source {
 public:
  // Reads the first picture, to check its size. `stop`, which outlives the source, ends all waiting. Errors:
  // InvalidArgument (the camera has no source), those of platform::VideoInput::open, FrameSize.
  static Result<std::unique_ptr<Source>> open(const Rig& rig, const RigCamera& camera, const std::atomic<bool>& stop);
  virtual ~Source() = default;
  // Waits for the next picture, and gives it into `out`, whose memory is used again. Pictures of a file that are late
  // are left out. False: `stop` was set. Errors: FileUnreadable, FrameSize.
  virtual Result<bool> next(SourcePicture& out) = 0;
};

}  // namespace fourdvt::live
