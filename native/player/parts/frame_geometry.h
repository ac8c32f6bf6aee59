// SPDX-License-Identifier: Apache-2.0
// One frame of a GOP's decoded geometry: of a layered character frames of one mesh, of a character from cameras a
// surface. A view only: Loading owns what it points to, until the GOP leaves its cache.
#pragma once

#include "package/stream_file.h"
#include "package/surface_chunk.h"

namespace fourdvt {

struct FrameGeometry {
  const package::ChunkFrames* frames = nullptr;  // null: not there yet, or surfaces are
  const package::StreamIndex* index = nullptr;
  uint32_t row = 0;                                 // of the frame in its GOP
  const package::SurfaceChunk* surfaces = nullptr;  // of a character from cameras; null: not there yet
  explicit operator bool() const { return frames || surfaces; }
};

}  // namespace fourdvt
