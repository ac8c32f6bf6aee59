// SPDX-License-Identifier: Apache-2.0
// Pictures of one frame cropped to the performer, and optical flow between a posed mesh and such a picture.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "track/graph.h"

namespace fourdvt::track {

// One camera's picture around the performer.
struct View {
  PinholeCamera camera;  // camera of the crop; width 0: the camera does not see the performer
  cv::Mat grey, matte;   // 8 bits
  bool empty() const { return camera.width == 0; }
};

// Crops each picture to its matte with a margin of `margin_px`. `pictures`: RGBA, one per camera.
std::vector<View> viewsOf(std::span<const PinholeCamera> cameras, std::span<const Image> pictures, int margin_px);

// A mesh whose vertices were matched with the pictures of a frame.
struct PosedViews {
  const std::vector<View>* views = nullptr;  // one per camera
  const Positions* positions = nullptr;
};

// Gradients of a pixel's x and y by a point's position in the world, pixels per metre.
glm::dmat2x3 pixelGradients(const PinholeCamera& camera, const glm::dvec3& point);

// Unit vertex normals.
std::vector<glm::vec3> normalsOf(const std::vector<glm::uvec3>& faces, const Positions& positions);

struct FlowMatchOptions {
  double sigma_px = 1;          // noise of a match
  double consistency_px = 1.5;  // forward and backward flow
  double min_cosine = 0.35;     // between a vertex's normal and the direction to the camera
  double noise_per_px = 3;      // noise of the picture's gradient, levels of 255: matches do not count along an edge
  int reduction = 1;
};

// [vertex] the largest cosine between its normal and the direction to a camera that sees it; 0: seen by none.
std::vector<float> visibilityOf(const std::vector<View>& views, const std::vector<glm::uvec3>& faces,
                                const Positions& positions, std::span<const glm::vec3> normals);

// Observed position of a vertex in a camera's picture.
struct PixelMatch {
  uint32_t camera = 0, vertex = 0;
  glm::dvec2 pixel{0};
  glm::dmat2 information{0.0};  // inverse covariance, per pixel²
};

// Matches vertices at `positions` by optical flow in each camera: from the appearance of `source` on the mesh in that
// pose to the picture of `target`.
std::vector<PixelMatch> matchByFlow(std::span<const glm::uvec3> faces, const PosedViews& source,
                                    const std::vector<View>& target, const Positions& positions,
                                    std::span<const glm::vec3> normals, const FlowMatchOptions& options);

// Adds data terms of matches to `pulls`, linearised at `positions`; residuals beyond `reach_px` have no weight.
void addPulls(std::span<const PixelMatch> matches, const std::vector<View>& target, const Positions& positions,
              double reach_px, std::vector<Pull>& pulls);

}  // namespace fourdvt::track
