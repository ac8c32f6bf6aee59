// SPDX-License-Identifier: Apache-2.0
#include "bake/quality.h"

namespace fourdvt::bake {

const std::vector<Quality>& qualities() {
  // Measured on the sample's walk (28 frames, GOPs of 14, 4DVT's naive labels, 12 held-out views; SSIM-FG and
  // PSNR-FG of the rendered view against the truth, video only):
  //   512², uncompressed   0.713 21.97 dB   1024², uncompressed   0.775 22.43 dB
  //   draft  H.264 1.86 Mbit/s 0.673 21.63 dB · VP9 1.60 0.678 21.65 dB · AV1 1.38 0.674 21.65 dB
  //   web    H.264 3.70 Mbit/s 0.739 22.13 dB · VP9 3.35 0.742 22.12 dB · AV1 3.54 0.747 22.19 dB
  //   high   H.264 7.46 Mbit/s 0.756 22.27 dB · VP9 5.20 0.753 22.22 dB · AV1 4.38 0.751 22.22 dB
  static const std::vector<Quality> table{
      {"draft", "fast to bake and small: texture 512", 512, 3, {28, 42, 42}, {"veryfast", "5", "7"}},
      {"web", "for pages, about 4 Mbit/s: texture 1024", 1024, 3, {31, 46, 43}, {"slow", "3", "6"}},
      {"high",
       "close to the uncompressed layers: texture 1024 at twice the bitrate",
       1024,
       3,
       {26, 40, 40},
       {"slow", "2", "6"}},
  };
  return table;
}

const Quality* findQuality(const std::string& name) {
  for (const Quality& quality : qualities())
    if (name == quality.name) return &quality;
  return nullptr;
}

void applyQuality(const Quality& quality, Codec codec, BakeOptions& options) {
  options.texture = quality.texture;
  options.layers = quality.layers;
  options.codec = codec;
  options.crf = quality.crf[static_cast<int>(codec)];
  options.preset = quality.preset[static_cast<int>(codec)];
}

}  // namespace fourdvt::bake
