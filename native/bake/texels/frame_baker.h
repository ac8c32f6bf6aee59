// SPDX-License-Identifier: Apache-2.0
// Visibility and filled layers of one frame, from its pictures. Used by the survey and the GOP stage of a bake, and
// without a codec by the study.
#pragma once

#include <memory>
#include <vector>

#include "bake/texels/colour_calibration.h"
#include "bake/texels/fill.h"
#include "bake/texels/gpu_capture.h"
#include "bake/texels/picture_crop.h"
#include "bake/texels/resample.h"

namespace fourdvt::bake {

// Measures on the GPU the visible share of each face in each camera: tests seven sample points per face against the
// depth map, the picture's border and the matte.
class Visibility {
 public:
  // Errors: GpuFailure.
  static Result<Visibility> create(gpu::Device& device, const GpuCapture& capture);
  // Visible share of each face in the capture's current frame: [camera][face], 0…1.
  Result<std::vector<float>> measure(gpu::Device& device, const GpuCapture& capture);

 private:
  gpu::Program program_;
  gpu::Texture table_;
  gpu::Target target_;
  int rows_ = 0;  // rows per camera
};

struct FrameBakerOptions {
  // Side of every layer in texels; that of layer 0 may be a multiple of the others'. Empty: visibility only.
  std::vector<int> layer_sizes;
  float gutter_texels = 10;  // in texels of layer 0
  ResampleOptions resample;
  std::vector<ColourMap> colour_maps;  // one per camera; empty: uncorrected
  float length_scale = 1;              // lengthScale in base/mesh.h
};

class FrameBaker {
 public:
  // `pose`: positions of any frame, from which the minification of pictures by layers is estimated. Errors:
  // GpuFailure.
  static Result<std::unique_ptr<FrameBaker>> create(gpu::Device& device, const std::vector<PinholeCamera>& cameras,
                                                    const MeshTopology& topology, const Positions& pose,
                                                    const FrameBakerOptions& options);
  // Uploads a frame (positions in the topology's order) and draws its depth maps.
  void setFrame(const Positions& positions, const std::vector<PictureCrop>& crops);
  // Visible share of each face in the current frame: [camera][face], 0…1.
  Result<std::vector<float>> measureVisibility();
  // Layers of the current frame, not filled. labels: [layer][face].
  Result<std::vector<Image>> resample(const std::vector<uint8_t>& labels);
  // Resamples by another rule than the faces' labels.
  Result<std::vector<Image>> resample(TexelRule rule, const std::vector<uint8_t>& order);
  // Fills holes, gutters and unused texels. Runs on the CPU only; any thread may call it.
  void fill(std::vector<Image>& layers) const;

 private:
  gpu::Device* device_ = nullptr;
  GpuCapture capture_;
  Visibility visibility_;
  Resampler resampler_;
  GutterMap large_map_, small_map_;
  std::vector<const GutterMap*> maps_;  // [layer]
};

}  // namespace fourdvt::bake
