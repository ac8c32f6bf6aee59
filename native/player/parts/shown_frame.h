// SPDX-License-Identifier: Apache-2.0
// The frame that one track shows, as it goes into the figure: labels and alignment on the GPU, and the mesh blended at
// the present weights. Does NOT choose the frame or the weights, and does NOT upload the mesh (figure_composer.h).
#pragma once

#include <optional>
#include <vector>

#include "base/mesh.h"
#include "motion/parameter_space.h"
#include "player/parts/frame_geometry.h"
#include "render/appearance.h"

namespace fourdvt {

class ShownFrame {
 public:
  // Labels and alignment of the frame go on screen; its mesh is stale until it is blended. Errors: GpuFailure.
  Status present(gpu::Device& device, const render::CharacterModel& model, const package::Sequence& sequence,
                 const FrameGeometry& geometry);
  bool stale() const { return stale_; }  // the mesh is not that of the presented frame at the present weights
  void markStale() { stale_ = true; }
  void blend(const FrameGeometry& geometry, const motion::BlendWeights& weights);
  void release() { appearance_.reset(); }  // nothing is on screen any more

  const render::Appearance& appearance() const { return *appearance_; }  // of a frame that was presented
  const Positions& positions() const { return positions_; }              // as blended last

 private:
  std::optional<render::Appearance> appearance_;
  Positions positions_;
  bool stale_ = false;
  std::vector<glm::vec2> alignment_;  // scratch
};

}  // namespace fourdvt
