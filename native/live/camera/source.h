// SPDX-License-Identifier: Apache-2.0
// Pictures of one camera in real time, not undistorted. A file is played in a loop, locked to the machine's clock, so
// that all processes of a stage show the same moment.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/image.h"
#include "base/result.h"
#include "live/rig/rig.h"

namespace fourdvt::live {

int64_t systemNow_us();  // time since 1970

// Slot of a file's picture at a time: slot k begins k / fps seconds after 1970 and shows picture k modulo the number of
// pictures.
int64_t slotAt(int64_t now_us, double fps);
int64_t slotBegin_us(int64_t slot, double fps);

struct SourcePicture {
  Image rgb;
  int64_t captured_us = 0;  // begin of the slot for a file; else the device's time stamp, or the time of arrival
};

class Source {
 public:
  // Reads the first picture to check its size. `stop` outlives the source and ends all waiting. Errors: InvalidArgument
  // (the camera has no source), those of platform::VideoInput::open, FrameSize.
  static Result<std::unique_ptr<Source>> open(const Rig& rig, const RigCamera& camera, const std::atomic<bool>& stop);
  virtual ~Source() = default;
  // Waits for the next picture and writes it to `out`, whose memory is reused. Late pictures of a file are dropped.
  // False: `stop` was set. Errors: FileUnreadable, FrameSize.
  virtual Result<bool> next(SourcePicture& out) = 0;
};

}  // namespace fourdvt::live
