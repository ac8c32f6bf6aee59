// SPDX-License-Identifier: Apache-2.0
// One frame of a live stream: surface, tile placement of the camera pictures, and one video sample, all still coded.
// Byte layout: FORMAT.md, "A live stream".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace fourdvt::package {

struct LiveFrame {
  uint32_t number = 0;              // previous number + 1, or a gap, then a key
  bool key = false;                 // sample decodes without predecessors
  int64_t captured_us = 0;          // server clock, since 1970
  std::span<const uint8_t> chunk;   // chunk of a camera stream with one frame (surface_chunk.h)
  std::span<const uint8_t> sample;  // H.264 Annex B; a key contains the parameter sets
};

constexpr size_t kMaxLiveFrameBytes = 8u << 20;

std::vector<uint8_t> writeLiveFrame(const LiveFrame& frame);
// Spans of the result borrow `bytes`. Errors: StreamInvalid; Unsupported (newer).
Result<LiveFrame> readLiveFrame(std::span<const uint8_t> bytes);

}  // namespace fourdvt::package
