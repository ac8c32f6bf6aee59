// SPDX-License-Identifier: Apache-2.0
#include "bake/quality.h"

namespace fourdvt::bake {

const std::vector<Quality>& qualities() {
  // Measured on the sample's run (19 frames, joint labels, 12 held-out views, mesh refined; video only; SSIM-FG and
  // PSNR-FG of the rendered view against the truth; `fourdvt-lab study`, section "Rate and distortion"). Uncompressed
  // 0.842, 24.64 dB.
  //   draft  H.264 1.90 Mbit/s 0.767 23.65 dB · VP9 2.17 0.796 24.02 dB · AV1 1.69 0.790 24.00 dB
  //   web    H.264 4.49 Mbit/s 0.808 24.23 dB · VP9 3.32 0.810 24.21 dB · AV1 3.83 0.813 24.28 dB
  //   high   H.264 9.39 Mbit/s 0.826 24.43 dB · VP9 8.15 0.829 24.47 dB · AV1 6.23 0.823 24.39 dB
  // (VP9 and AV1 of draft with the presets of web; H.264 of draft at CRF 36.) H.264 at CRF 32: 2.90 Mbit/s 0.791 24.03
  // dB. At every bitrate 1024 texels beat 512 (3.14 Mbit/s 0.762); with AV1 2048 at CRF 50 gives 0.829 at 4.97 Mbit/s.
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

void applyQuality(const Quality& quality, encode::Codec codec, BakeOptions& options) {
  options.texture = quality.texture;
  options.layers = quality.layers;
  options.codec = codec;
  options.crf = quality.crf[static_cast<int>(codec)];
  options.preset = quality.preset[static_cast<int>(codec)];
}

}  // namespace fourdvt::bake
