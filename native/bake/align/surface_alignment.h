// SPDX-License-Identifier: Apache-2.0
// Aligns the members' appearance on the surface at bake time (algorithms/alignment.md). Every member is rendered on
// the same blended mesh from a ring of views. Optical flow in both directions in each view gives one tangent
// displacement per vertex that fits all views, weighted by facing, forward-backward error and texture; it is
// smoothed, and 0 where nothing is certain. The decoded pictures are aligned, because the player shows them. The
// displacement is exact at equal weights, where both appearances meet. Data flow: views.h (renders, and measures
// visibility) → tangent_field.h (flow → vertices → smooth field, clipped at gutters).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/recipe.h"

namespace fourdvt::bake {

struct AlignmentOptions {
  int views = 12;            // on a ring round the character, every other one raised
  int picture_height = 640;  // pixels
  double smoothness = 1;     // weight of the screened Laplacian
  double max_displacement_m = 0.04;
  int gutter_texels = 10;  // gutter of layer 1; displacements that leave a chart further than this are shortened
  int jobs = 2;  // views measured concurrently, on threads beside the rendering one; 1: on the rendering thread
};

struct AlignedFrame {
  std::vector<glm::vec2> displacement_m;  // [member - 1][vertex], along the tangents of base/mesh.h
  std::vector<float> confidence;          // [member - 1][vertex], 0..1
  float detail_correlation = 1;           // correlation of the members' pictures after this displacement; see views.h
};

class SurfaceAligner {
 public:
  // Errors: GpuFailure, InvalidArgument.
  static Result<std::unique_ptr<SurfaceAligner>> create(gpu::Device& device, const package::Character& character,
                                                        const package::BaseMesh& mesh, const AlignmentOptions& options);
  ~SurfaceAligner();
  // Aligns one frame: the class's decoded picture and labels (`appearance`, set for this frame) on `middle`, the
  // blend of all members at equal weights.
  Result<AlignedFrame> align(const Positions& middle, const render::Appearance& appearance,
                             const render::PictureTextures& picture);

 private:
  class Views;
  explicit SurfaceAligner(std::unique_ptr<Views> views);

  std::unique_ptr<Views> views_;
};

// Smooths the displacements over time: confident frames pull their neighbours; loops wrap. `frames`: one whole GOP
// window or sequence.
void steadyAlignment(std::vector<AlignedFrame>& frames, bool loop);

}  // namespace fourdvt::bake
