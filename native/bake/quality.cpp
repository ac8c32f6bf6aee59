// SPDX-License-Identifier: Apache-2.0
#include "bake/quality.h"

namespace fourdvt::bake {

const std::vector<Quality>& qualities() {
  // Measured on the sample's run (19 frames, joint labels, 12 held-out views, mesh refined; video only; SSIM-FG and
  // PSNR-FG of the rendered view against the truth; `fourdvt evaluate`, section "Rate and distortion"). Uncompressed
  // 0.834, 24.60 dB.
  //   draft  H.264 1.72 Mbit/s 0.749 23.50 dB · VP9 2.00 0.786 23.96 dB · AV1 1.60 0.779 23.94 dB
  //   web    H.264 4.60 Mbit/s 0.800 24.22 dB · VP9 3.01 0.799 24.15 dB · AV1 3.52 0.802 24.21 dB
  //   high   H.264 8.07 Mbit/s 0.815 24.38 dB · VP9 7.22 0.819 24.41 dB · AV1 5.59 0.812 24.33 dB
  // (VP9 and AV1 of draft with the presets of web; H.264 of high at CRF 24.) H.264 at CRF 32: 2.60 Mbit/s 0.779 24.00
  // dB. At every bitrate 1024 texels beat 512 (2.67 Mbit/s 0.729), and 1536 or 2048 gain nothing below 10 Mbit/s with
  // H.264; with AV1 2048 at CRF 50 gives 0.819 at 4.51 Mbit/s.
  static const std::vector<Quality> table{
      {"draft", "small and fast to bake, about 2 Mbit/s", 1024, 3, {37, 52, 52}, {"veryfast", "5", "7"}},
      // The default: BakeOptions repeats its values for H.264, and quality_test.cpp compares them.
      {"web", "for pages, about 5 Mbit/s of video", 1024, 3, {29, 46, 40}, {"slower", "3", "6"}},
      {"high", "close to the uncompressed layers, about 10 Mbit/s", 1024, 3, {24, 34, 34}, {"slower", "3", "6"}},
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
