// SPDX-License-Identifier: Apache-2.0
// The sound of sequences in a manifest. Native only: a page reads it by itself, once it is heard.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "package/character.h"

namespace fourdvt::package {

constexpr int kMaxSoundEncodings = 8, kMaxSoundSegments = 1 << 16, kMaxSteps = 4096;

// The sound of a plain sequence, or of the steps of a class, in the encodings that a page chooses from. It is cut into
// segments that are files of their own, so that a page need not hold all of it. Not part of Character: native players
// and the page's player have no use for it.
struct SoundSegment {
  uint32_t bytes = 0, samples = 0;  // that a decoder gives which honours the file's priming
};
struct SoundEncoding {
  std::string uri;
  uint64_t bytes = 0, hash = 0;  // of the file: all segments, one behind the other
  std::string mime_type;         // with the codec
  uint32_t priming = 0;          // samples that some decoders give before the others
  std::vector<SoundSegment> segments;
};
struct Sound {
  int sample_rate = 0, channels = 0;
  double segment_s = 0;                  // segment i begins at i times this; it goes on a little after its end
  std::vector<SoundEncoding> encodings;  // none: there is no sound
  std::vector<double> steps;             // of a class: phases in 0..1 at which a foot comes down
};

using Sounds = std::map<std::string, Sound>;  // by the sequence's name

// Gives no encodings if the sequence has no sound. Errors: ManifestInvalid.
Result<Sound> readSound(const FlatJson& gltf, size_t sequence);

}  // namespace fourdvt::package
