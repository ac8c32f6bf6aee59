// SPDX-License-Identifier: Apache-2.0
#include "lab/labels/per_texel.h"

#include <algorithm>
#include <utility>

namespace fourdvt::lab {
namespace {

// Ranks, per texel, the cameras in which it is visible (alpha = rank + 1) and returns layer l: each texel from its l-th
// camera.
Image pickRanked(const std::vector<Image>& cameras, size_t l) {
  Image out(cameras[0].width, cameras[0].height, 4);
  std::vector<std::pair<uint8_t, const uint8_t*>> seen;
  for (size_t i = 0; i < out.pixels.size(); i += 4) {
    seen.clear();
    for (const Image& camera : cameras)
      if (camera.pixels[i + 3]) seen.emplace_back(camera.pixels[i + 3], &camera.pixels[i]);
    if (seen.size() <= l) continue;
    std::nth_element(seen.begin(), seen.begin() + l, seen.end());
    std::copy_n(seen[l].second, 3, &out.pixels[i]);
    out.pixels[i + 3] = 255;
  }
  return out;
}

}  // namespace

Result<std::vector<Image>> resamplePerTexel(bake::Resampler& resampler, gpu::Device& device,
                                            const bake::GpuCapture& capture, const std::vector<uint8_t>& order) {
  std::vector<Image> cameras, out;
  for (size_t l = 0; l < resampler.layerCount(); ++l) {
    if (cameras.empty() || cameras[0].width != resampler.layerSize(l)) {
      FOURDVT_ASSIGN(cameras, resampler.resampleByRank(device, capture, l, order));
    }
    out.push_back(pickRanked(cameras, l));
  }
  return out;
}

}  // namespace fourdvt::lab
