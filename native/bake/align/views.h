// SPDX-License-Identifier: Apache-2.0
// First part of baked alignment: a ring of views, visibility and image-space motion of the mesh in them, and the
// comparison of the members' pictures.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// `count` cameras on a ring round the points, every other one raised; each picture is `height` pixels high and as
// wide as the points need, with a margin for flow windows. Points must span a volume.
std::vector<PinholeCamera> alignmentCameras(const Positions& positions, int count, int height);

// [vertex] 3-D movement on this pose for one metre along each of the base's tangents: least squares over the edges
// round the vertex, perpendicular to the pose's normal. Zero where the base or the pose has no area.
std::vector<glm::mat2x3> poseTangents(const MeshTopology& topology, std::span<const glm::vec3> base,
                                      const SurfaceFrames& frames, std::span<const glm::vec3> pose);

// A vertex that is visible in a view.
struct SeenVertex {
  uint32_t vertex = 0;
  glm::vec2 pixel{0};          // pixel centres at +0.5
  float cosine = 0;            // between normal and ray
  float pixels_per_metre = 0;  // across the ray
  glm::mat2 pixels_from_tangents{0};
};

// Depth along the optical axis, metres; +infinity where there is no surface. CV_32F.
cv::Mat drawDepth(const PinholeCamera& camera, const MeshTopology& topology, const Positions& positions);

// CV_32F 0..1: 0 at depth steps and silhouettes, where optical flow is unreliable, rising to 1 `reach` pixels inside.
cv::Mat interiorOf(const cv::Mat& depth, float reach);

// Depth-tested, front-facing vertices inside the picture.
std::vector<SeenVertex> seenVertices(const PinholeCamera& camera, const cv::Mat& depth, const Positions& positions,
                                     const std::vector<glm::vec3>& normals, const std::vector<glm::mat2x3>& tangents);

// Luma, CV_8U, with local mean and contrast equalised over the figure, so that shading and exposure do not influence
// the flow; mid-grey elsewhere, so that the static outline does not influence it either.
cv::Mat evenLuma(const cv::Mat& rgba);

// Share of detail that survives averaging several appearances of one surface: their gradients' correlation. Noise,
// compression and folds that differ between motions stay uncorrelated under any alignment; their mean has less
// contrast than each of them (E. Heitz, F. Neyret: High-Performance By-Example Noise using a Histogram-Preserving
// Blending Operator, Proceedings of the ACM on Computer Graphics and Interactive Techniques 1(2), 2018:
// variance-preserving blending). The renderer restores the contrast (render/layered_pass).

// Gradient energies of the members' pictures of one view, over the pixels that all of them cover.
struct DetailEnergy {
  std::vector<double> own;  // [member]
  double sum = 0;           // gradient energy of the pictures' sum
};

// [member] CV_8UC4 of one view, two or more, the same outline.
DetailEnergy detailEnergy(const std::vector<cv::Mat>& looks);

// 0..1: the mean of n pictures keeps (1 + (n - 1) value) / n of their gradient energy. 1 without any covered pixel.
float detailCorrelation(const std::vector<DetailEnergy>& views);

}  // namespace fourdvt::bake
