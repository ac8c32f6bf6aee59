// SPDX-License-Identifier: Apache-2.0
// Compares the pictures on planes inside the hull, on the GPU. Does NOT decide where the surface is.
// Order of calls: setFrame → costs….
#pragma once

#include <span>

#include "base/image.h"
#include "base/mesh.h"
#include "gpu/device.h"
#include "reconstruct/stereo/depth_map.h"

namespace fourdvt::reconstruct {

struct PlaneSweepOptions {
  int radius = 1;                  // of a patch: 2 radius + 1 samples along each side
  float spacing = 1.5f;            // of its samples, pixels of the reduced picture
  float step_m = 0.004f;           // between planes, along the optical axis
  int labels = 64;                 // planes per pixel, from the hull's front; a multiple of 4, at most kMaxLabels
  float correlation_share = 0.6f;  // of the cost; the rest is the difference of mean colours
};

class PlaneSweep {
 public:
  // Cameras of the reduced pictures. `device` is borrowed. Errors: GpuFailure.
  static Result<PlaneSweep> create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                   const PlaneSweepOptions& options);
  // RGBA of the cameras' sizes, alpha = matte. Errors: GpuFailure.
  Status setFrame(std::span<const Image> pictures, const TriangleMesh& hull);
  // Costs in the band inside the hull's front. Width 0 if the reference does not see the hull. Errors: GpuFailure.
  Result<CostVolume> costs(const StereoReference& reference);

 private:
  Result<gpu::ProgramId> programFor(size_t sources);
  Status drawFront(const PinholeCamera& camera, const PictureRegion& region);

  gpu::Device* device_ = nullptr;
  std::vector<PinholeCamera> cameras_;
  PlaneSweepOptions options_;
  int layer_width_ = 0, layer_height_ = 0;
  gpu::Program front_program_;
  std::vector<gpu::Program> cost_programs_;  // by number of sources
  gpu::Texture pictures_, corners_, positions_, front_, costs_;
  gpu::Target front_target_, costs_target_;
  Positions hull_;
  int corner_count_ = 0, corner_rows_ = 0, position_rows_ = 0;
  int front_width_ = 0, front_height_ = 0, costs_width_ = 0, costs_height_ = 0;
};

}  // namespace fourdvt::reconstruct
