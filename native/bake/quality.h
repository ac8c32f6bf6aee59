// SPDX-License-Identifier: Apache-2.0
// Named quality settings of `fourdvt bake --quality`. quality.cpp lists the measurements behind each entry;
// `fourdvt-lab study` repeats them.
#pragma once

#include <string>
#include <vector>

#include "bake/bake.h"

namespace fourdvt::bake {

struct Quality {
  const char* name;     // "draft", "web", "high"
  const char* meaning;  // one line of the help
  int texture, layers;
  // Per codec, in the order of the enum: CRF on the codec's own scale, and the encoder's preset.
  int crf[encode::kCodecs];
  const char* preset[encode::kCodecs];
};

constexpr const char* kDefaultQuality = "web";

const std::vector<Quality>& qualities();  // lowest bitrate first
// nullptr for an unknown name.
const Quality* findQuality(const std::string& name);
// Sets texture, layers, codec, crf and preset; the rest of `options` stays.
void applyQuality(const Quality& quality, encode::Codec codec, BakeOptions& options);

}  // namespace fourdvt::bake
