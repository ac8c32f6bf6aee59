// SPDX-License-Identifier: Apache-2.0
// Manifest of a live stream (FORMAT.md, "A live stream"), validated: a character from cameras without files, whose one
// sequence is what comes. Does NOT read its frames (live_frame.h).
#pragma once

#include "base/flat_json.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

struct LiveCharacter {
  Character character;   // one sequence "live" of one rendition
  StreamIndex index;     // of one GOP of one frame, as SurfaceChunk::open takes it for the chunk of every LiveFrame
  uint64_t session = 0;  // another one: the stream has begun anew, and so have its numbers
};

// Errors: ManifestInvalid; Unsupported (newer).
Result<LiveCharacter> readLiveManifest(const FlatJson& manifest);

}  // namespace fourdvt::package
