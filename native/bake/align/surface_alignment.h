// SPDX-License-Identifier: Apache-2.0
// Alignment of the members' appearance, lifted to the surface at bake time (ALGORITHMS 5.1): every member is
// drawn from a ring of views on the same blended mesh; flow both ways in each view; a tangent displacement a vertex
// that agrees with all of them, weighted by facing, forward-backward error and texture; smooth; 0 where nothing is
// certain. What is aligned is what is shown: the pictures are the decoded ones. A displacement is found for the place
// where both looks come together at equal weights, so that this is where it is exact. Does NOT code or store. Stages,
// in order: surface_alignment_looks (draw), _views (what is seen), _lift (flow → vertices), _smooth, _charts (gutters),
// _detail (what the blend will lack); over time: _time.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/recipe.h"

namespace fourdvt::bake {

struct AlignmentOptions {
  int views = 12;            // on a ring round the character, every other one raised
  int picture_height = 640;  // pixels
  double smoothness = 1;     // of the screened Laplacian
  double max_displacement_m = 0.04;
  int gutter_texels = 10;  // of layer 1: displacements that leave a chart further than this are cut
};

struct AlignedFrame {
  std::vector<glm::vec2> displacement_m;  // [member - 1][vertex], along the tangents of base/surface_frame.h
  std::vector<float> confidence;          // likewise, 0..1
  float detail_correlation = 1;           // of the members' looks, moved by just this; see detail.h
};

class SurfaceAligner {
 public:
  // Errors: GpuFailure, InvalidArgument.
  static Result<std::unique_ptr<SurfaceAligner>> create(gpu::Device& device, const package::Character& character,
                                                        const package::BaseMesh& mesh, const AlignmentOptions& options);
  virtual ~SurfaceAligner() = default;
  // One frame: the class's decoded picture and labels (`appearance`, set for this frame), on `middle`: the blend of all
  // members at equal weights.
  virtual Result<AlignedFrame> align(const Positions& middle, const render::Appearance& appearance,
                                     const render::PictureTextures& picture) = 0;
};

// Over time: confident frames steady the others; loops wrap. frames: of one whole GOP window or sequence.
void steadyAlignment(std::vector<AlignedFrame>& frames, bool loop);

}  // namespace fourdvt::bake
