// SPDX-License-Identifier: Apache-2.0
#include "bake/quality.h"

namespace fourdvt::bake {

const std::vector<Quality>& qualities() {
  // Measured on the sample's walk (28 frames, joint labels, 12 held-out views; video only; SSIM-FG and PSNR-FG of the
  // rendered view against the truth; `fourdvt evaluate`, section "Rate and distortion"). Uncompressed 0.773, 22.50 dB.
  //   draft  H.264 1.79 Mbit/s 0.702 21.87 dB · VP9 2.09 0.734 22.14 dB · AV1 1.65 0.728 22.13 dB
  //   web    H.264 4.82 Mbit/s 0.747 22.30 dB · VP9 3.19 0.746 22.26 dB · AV1 3.73 0.748 22.28 dB
  //   high   H.264 9.71 Mbit/s 0.761 22.40 dB · VP9 7.58 0.762 22.40 dB · AV1 5.92 0.756 22.35 dB
  // (VP9 and AV1 of draft with the presets of web.) H.264 at CRF 32: 2.73 Mbit/s 0.730 22.17 dB. At every bitrate 1024
  // texels beat 512 (2.69 Mbit/s 0.687), and 1536 or 2048 gain nothing below 10 Mbit/s with H.264; with AV1 2048 at CRF
  // 50 gives 0.762 at 4.75 Mbit/s.
  static const std::vector<Quality> table{
      {"draft", "small and fast to bake, about 2 Mbit/s", 1024, 3, {36, 52, 52}, {"veryfast", "5", "7"}},
      // The default: BakeOptions repeats its values for H.264, and quality_test.cpp compares them.
      {"web", "for pages, about 5 Mbit/s of video", 1024, 3, {28, 46, 40}, {"slow", "3", "6"}},
      {"high", "close to the uncompressed layers, about 10 Mbit/s", 1024, 3, {23, 34, 34}, {"slow", "3", "6"}},
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
