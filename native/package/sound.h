// SPDX-License-Identifier: Apache-2.0
// Sound of sequences in a manifest. Native only: a page parses it itself once sound is on.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "package/character.h"

namespace fourdvt::package {

constexpr int kMaxSoundEncodings = 8, kMaxSoundSegments = 1 << 16, kMaxSteps = 4096;

// Sound of a plain sequence, or of a class's footsteps, in alternative encodings. Segments are separate files, so that
// a page need not hold all of it. Separate from Character: the players do not use it.
struct SoundSegment {
  uint32_t bytes = 0, samples = 0;  // sample count from a decoder that honours the file's priming
};
struct SoundEncoding {
  std::string uri;
  uint64_t bytes = 0, hash = 0;  // whole file: all segments, concatenated
  std::string mime_type;         // including the codec
  uint32_t priming = 0;          // leading samples that some decoders output
  std::vector<SoundSegment> segments;
};
struct Sound {
  int sample_rate = 0, channels = 0;
  double segment_s = 0;                  // segment i begins at i * segment_s; it extends a little into the next one
  std::vector<SoundEncoding> encodings;  // empty: no sound
  std::vector<double> steps;             // class only: phases in 0..1 of foot contacts
};

using Sounds = std::map<std::string, Sound>;  // keyed by sequence name

// Gives no encodings if the sequence has no sound. Errors: ManifestInvalid.
Result<Sound> readSound(const FlatJson& gltf, size_t sequence);

}  // namespace fourdvt::package
