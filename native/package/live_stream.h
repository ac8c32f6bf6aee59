// SPDX-License-Identifier: Apache-2.0
// Manifest and frames of a live stream: a character from cameras without files, whose one sequence is the incoming
// frames. Byte layout: FORMAT.md, "A live stream".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/flat_json.h"
#include "base/result.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// One frame: surface, tile placement of the camera pictures, and one video sample, all still coded.
struct LiveFrame {
  uint32_t number = 0;              // previous number + 1; after a gap, the frame is a key
  bool key = false;                 // sample decodes without predecessors
  int64_t captured_us = 0;          // server clock, µs since 1970
  std::span<const uint8_t> chunk;   // chunk of a camera stream with one frame (surface_chunk.h)
  std::span<const uint8_t> sample;  // H.264 Annex B; a key contains the parameter sets
};

constexpr size_t kMaxLiveFrameBytes = 8u << 20;

std::vector<uint8_t> writeLiveFrame(const LiveFrame& frame);
// Spans of the result borrow `bytes`. Errors: StreamInvalid; Unsupported (newer).
Result<LiveFrame> readLiveFrame(std::span<const uint8_t> bytes);

struct LiveCharacter {
  Character character;   // one sequence "live" of one rendition
  StreamIndex index;     // one GOP of one frame: index for SurfaceChunk::open of every LiveFrame's chunk
  uint64_t session = 0;  // changes when the stream restarts with new frame numbers
};

// Validates a stream's manifest. Errors: ManifestInvalid; Unsupported (newer).
Result<LiveCharacter> readLiveManifest(const FlatJson& manifest);

}  // namespace fourdvt::package
