// SPDX-License-Identifier: Apache-2.0
// Draws each member's look alone on the common mesh, with moved texture coordinates, as the recipe shows it.
// Looks of one view share their depth, so that only visible surface is shaded.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "render/recipe.h"

namespace fourdvt::bake {

class LookDrawer {
 public:
  // Character and mesh are borrowed. Errors: GpuFailure.
  static Result<std::unique_ptr<LookDrawer>> create(gpu::Device& device, const package::Character& character,
                                                    const package::BaseMesh& mesh);
  virtual ~LookDrawer() = default;
  // Sets the mesh to draw on and, per member, its texture coordinates (as many as the topology has).
  virtual Status setFrame(const Positions& positions, const std::vector<std::vector<glm::vec2>>& member_uvs) = 0;
  // [member] CV_8UC4, premultiplied.
  virtual Result<std::vector<cv::Mat>> draw(const PinholeCamera& camera, const render::Appearance& appearance,
                                            const render::PictureTextures& picture) = 0;
};

// Luma, CV_8U, with local mean and contrast evened out over the figure, so that shading and exposure do not influence
// the flow; mid-grey elsewhere, so that the outline, which does not move, does not influence it either.
cv::Mat evenLuma(const cv::Mat& rgba);

}  // namespace fourdvt::bake
