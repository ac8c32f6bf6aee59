// SPDX-License-Identifier: Apache-2.0
// The GPU's and fill's share of a bake for one frame at a time: pictures → visibility → layers. What bake.cpp runs in
// its lanes and what evaluation runs without a codec.
#pragma once

#include <memory>
#include <vector>

#include "bake/labels/labelling.h"
#include "bake/texels/colour_calibration.h"
#include "bake/texels/fill.h"
#include "bake/texels/picture_crop.h"
#include "bake/texels/resample.h"
#include "bake/texels/visibility.h"
#include "capture/capture.h"

namespace fourdvt::bake {

struct FrameBakerOptions {
  // Texels, a side each; layer 0 may be larger than the others (a multiple). Empty: visibility only.
  std::vector<int> layer_sizes;
  float gutter_texels = 10;  // of layer 0
  ResampleOptions resample;
  std::vector<ColourMap> colour_maps;  // one a camera; empty: pictures as they are
};

class FrameBaker {
 public:
  // Errors: GpuFailure. `pose`: any frame's positions, to judge how far layers minify the pictures.
  static Result<std::unique_ptr<FrameBaker>> create(gpu::Device& device, const std::vector<PinholeCamera>& cameras,
                                                    const MeshTopology& topology, const Positions& pose,
                                                    const FrameBakerOptions& options);
  // Uploads a frame (positions in the topology's order) and draws its depth maps.
  void setFrame(const Positions& positions, const std::vector<PictureCrop>& crops);
  // Of the current frame: [camera][face], 0..1.
  Result<std::vector<float>> measureVisibility();
  // Of the current frame, not filled. labels: [layer][face].
  Result<std::vector<Image>> resample(const std::vector<uint8_t>& labels);
  // LVDT's assignment texel by texel; order: [rank][face], all cameras by penalty, package::kNoCamera after the last.
  Result<std::vector<Image>> resamplePerTexel(const std::vector<uint8_t>& order);
  // CPU only, on any thread: holes, gutters and the rest.
  void fill(std::vector<Image>& layers) const;

 private:
  gpu::Device* device_ = nullptr;
  GpuCapture capture_;
  Visibility visibility_;
  Resampler resampler_;
  GutterMap large_map_, small_map_;
  std::vector<const GutterMap*> maps_;  // a layer each
};

}  // namespace fourdvt::bake
