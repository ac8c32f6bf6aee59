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
  // The mesh to draw on, and for every member the texture vertices to draw with (as many as the topology's).
  virtual Status setFrame(const Positions& positions, const std::vector<std::vector<glm::vec2>>& member_uvs) = 0;
  // [member] CV_8UC4, premultiplied.
  virtual Result<std::vector<cv::Mat>> draw(const PinholeCamera& camera, const render::Appearance& appearance,
                                            const render::PictureTextures& picture) = 0;
};

// Luma, CV_8U, of even local mean and contrast over the figure, so that shading and exposure say nothing; mid-grey
// elsewhere, so that the outline, which stands still, says nothing either.
cv::Mat evenLuma(const cv::Mat& rgba);

}  // namespace fourdvt::bake
