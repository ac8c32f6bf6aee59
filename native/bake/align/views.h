// SPDX-License-Identifier: Apache-2.0
// First part of baked alignment: where the mesh is looked at from, what is seen there, and how it moves on the
// picture. Does NOT draw looks (looks.h).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "base/camera.h"
#include "base/surface_frame.h"

namespace fourdvt::bake {

// `count` cameras on a ring round the points, every other one raised; each picture is `height` pixels high and as wide
// as the points need, with a margin that flow windows may reach into. Points must span a volume.
std::vector<PinholeCamera> alignmentCameras(const Positions& positions, int count, int height);

// [vertex] 3-D movement on this pose for one metre along each of the base's tangents: least squares over the edges
// round the vertex, perpendicular to the pose's normal. Zero where the base or the pose has no area.
std::vector<glm::mat2x3> poseTangents(const MeshTopology& topology, std::span<const glm::vec3> base,
                                      const SurfaceFrames& frames, std::span<const glm::vec3> pose);

// A vertex that a view shows.
struct SeenVertex {
  uint32_t vertex = 0;
  glm::vec2 pixel{0};          // pixel centres at +0.5
  float cosine = 0;            // between normal and ray
  float pixels_per_metre = 0;  // across the ray
  glm::mat2 pixels_from_tangents{0};
};

// Depth along the optical axis, metres; +infinity where there is no surface. CV_32F.
cv::Mat drawDepth(const PinholeCamera& camera, const MeshTopology& topology, const Positions& positions);

// CV_32F 0..1: 0 at depth steps and silhouettes, 1 from `reach` pixels inside: flow does not cross them well.
cv::Mat interiorOf(const cv::Mat& depth, float reach);

// Depth-tested, front-facing vertices inside the picture.
std::vector<SeenVertex> seenVertices(const PinholeCamera& camera, const cv::Mat& depth, const Positions& positions,
                                     const std::vector<glm::vec3>& normals, const std::vector<glm::mat2x3>& tangents);

}  // namespace fourdvt::bake
