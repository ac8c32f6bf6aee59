// SPDX-License-Identifier: Apache-2.0
// Validated manifest of a live stream (FORMAT.md, "A live stream"): a character from cameras without files; its one
// sequence is the incoming frames (live_frame.h).
#pragma once

#include "base/flat_json.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

struct LiveCharacter {
  Character character;   // one sequence "live" of one rendition
  StreamIndex index;     // one GOP of one frame: index for SurfaceChunk::open of every LiveFrame's chunk
  uint64_t session = 0;  // changes when the stream restarts with new frame numbers
};

// Errors: ManifestInvalid; Unsupported (newer).
Result<LiveCharacter> readLiveManifest(const FlatJson& manifest);

}  // namespace fourdvt::package
