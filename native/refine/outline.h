// SPDX-License-Identifier: Apache-2.0
// Outlines of a mesh and edges of mattes. The outline consists of the edges between a front face and a back face with
// only background beyond. Computes distances between a camera's matte and the mesh's outline, draws them over the
// picture, and measures the distance of a matte's edge from the edge in the picture itself.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::refine {
// Mesh edge with two adjacent faces; outlines consist of such edges.
struct InnerEdge {
  uint32_t from = 0, to = 0;  // vertices
  uint32_t left_face = 0, right_face = 0;
};
std::vector<InnerEdge> innerEdges(std::span<const glm::uvec3> face_vertices);

// Sample on the outline.
struct OutlinePoint {
  uint32_t from = 0, to = 0;   // vertices of its edge
  float to_share = 0;          // 0: at `from` … 1: at `to`
  glm::vec3 point_in_cam{0};   // metres
  glm::vec2 outward{0};        // unit, away from the figure in the picture
  float pixels_per_metre = 0;  // motion of the outline along `outward` per metre of offset along the normal
  float residual_pixels = 0;   // from the mesh's outline to the matte's along `outward`; > 0: the mesh is too small
};

struct OutlineOptions {
  float reach_pixels = 12;      // search range for the matte's edge, per side
  float spacing_pixels = 2;     // between samples of an edge
  float matte_bias_pixels = 0;  // distance of the matte's edge outside the figure's; negative: eroded
};

// Matte cropped to the figure; pixel (x, y) of the camera is pixel (x - left, y - top) of `alpha`.
struct MatteCrop {
  Image alpha;  // one channel
  int left = 0, top = 0;
  float at(float x, float y) const;  // 0…255 at a position in the camera's picture, bilinear; 0 outside
};

// Samples the outline; points without a clear edge of the matte within reach are skipped. `normals`: unit, per vertex.
std::vector<OutlinePoint> outlinePoints(const PinholeCamera& camera, std::span<const glm::uvec3> face_vertices,
                                        std::span<const InnerEdge> edges, std::span<const glm::vec3> positions,
                                        std::span<const glm::vec3> normals, const MatteCrop& matte,
                                        const OutlineOptions& options);

// Draws a mesh's outline over a camera's picture. RGB, the part of `rgba` around the matte, darkened and enlarged
// twice, with a dot per point: green where the outlines agree within a quarter of a pixel, towards red where the mesh
// is too large, towards blue where it is too small (full colour from 2 pixels on). `camera`: the one that the points
// were measured with.
Image outlinePicture(const Image& rgba, const PinholeCamera& camera, std::span<const OutlinePoint> points);

// Places two pictures of equal height side by side.
Image beside(const Image& left, const Image& right);

// Distances of a matte's edge outside the picture's edge, pixels (negative: the matte is too small), at every
// `stride`-th pixel of the matte's edge where figure and background differ clearly in colour. Requires no mesh. `rgba`:
// alpha = matte. The figure's colour is sampled 4 to 7 pixels inside, the background's as far outside; the picture's
// edge is where linear light is the mean of both.
std::vector<double> matteEdgeOffsets(const Image& rgba, int stride);

}  // namespace fourdvt::refine
