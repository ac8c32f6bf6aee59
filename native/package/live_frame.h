// SPDX-License-Identifier: Apache-2.0
// One frame of a live stream: the surface, where the cameras' pictures lie, and one video sample. Byte layout:
// FORMAT.md, "A live stream". Does NOT decode either.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace fourdvt::package {

struct LiveFrame {
  uint32_t number = 0;              // one more than the frame before, unless frames were left out; then a key follows
  bool key = false;                 // the sample decodes without any before it
  int64_t captured_us = 0;          // by the server's clock, since 1970
  std::span<const uint8_t> chunk;   // of a stream from cameras, with one frame (surface_chunk.h)
  std::span<const uint8_t> sample;  // H.264 Annex B; a key has the parameter sets in it
};

constexpr size_t kMaxLiveFrameBytes = 8u << 20;

std::vector<uint8_t> writeLiveFrame(const LiveFrame& frame);
// Spans of the result borrow `bytes`. Errors: StreamInvalid; Unsupported (newer).
Result<LiveFrame> readLiveFrame(std::span<const uint8_t> bytes);

}  // namespace fourdvt::package
