// SPDX-License-Identifier: Apache-2.0
// One frame of a GOP's decoded geometry. A view only: Loading owns what it points to, until the GOP leaves its cache.
#pragma once

#include "package/stream_file.h"

namespace fourdvt {

struct FrameGeometry {
  const package::ChunkFrames* frames = nullptr;  // null: not there yet
  const package::StreamIndex* index = nullptr;
  uint32_t row = 0;  // of the frame in `frames`
  explicit operator bool() const { return frames != nullptr; }
};

}  // namespace fourdvt
