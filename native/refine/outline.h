// SPDX-License-Identifier: Apache-2.0
// How far a camera's matte lies from the mesh's outline, point by point along the outline. The outline consists of
// the edges between a face that the camera sees from the front and one that it sees from behind, where nothing but
// background lies beyond. Does NOT judge which of the two is right, and does NOT change anything.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::refine {
// An edge of the mesh with a face on either side; the outline is made of such edges.
struct InnerEdge {
  uint32_t from = 0, to = 0;  // vertices
  uint32_t left_face = 0, right_face = 0;
};
std::vector<InnerEdge> innerEdges(std::span<const glm::uvec3> face_vertices);

// One point of the outline.
struct OutlinePoint {
  uint32_t from = 0, to = 0;   // the vertices of its edge
  float to_share = 0;          // 0: at `from` … 1: at `to`
  glm::vec3 point_in_cam{0};   // metres
  glm::vec2 outward{0};        // unit, away from the figure in the picture
  float pixels_per_metre = 0;  // how far the outline moves along `outward` per metre of offset along the normal
  float residual_pixels = 0;   // from the mesh's outline to the matte's along `outward`; > 0: the mesh is too small
};

struct OutlineOptions {
  float reach_pixels = 12;      // the matte's edge is searched up to here on either side
  float spacing_pixels = 2;     // between points of an edge
  float matte_bias_pixels = 0;  // how far the matte's edge lies outside the figure's; negative: eroded
};

// A camera's matte round the figure; pixel (x, y) of the camera is pixel (x - left, y - top) of the picture.
struct MatteCrop {
  Image alpha;  // one channel
  int left = 0, top = 0;
  float at(float x, float y) const;  // 0…255 at a place of the camera's picture, bilinear; 0 outside
};

// Points without a clear edge of the matte within reach are left out. `normals`: unit, per vertex.
std::vector<OutlinePoint> outlinePoints(const PinholeCamera& camera, std::span<const glm::uvec3> face_vertices,
                                        std::span<const InnerEdge> edges, std::span<const glm::vec3> positions,
                                        std::span<const glm::vec3> normals, const MatteCrop& matte,
                                        const OutlineOptions& options);

// Draws a mesh's outline over a camera's picture, coloured by its distance from the matte's.

// RGB, the part of `rgba` round the matte, darkened and twice as large, with a dot at every point: green where the
// outlines agree to a quarter of a pixel, towards red where the mesh is too large, towards blue where it is too small
// (full colour from 2 pixels on). `camera`: the one that the points were taken with.
Image outlinePicture(const Image& rgba, const PinholeCamera& camera, std::span<const OutlinePoint> points);

// Two pictures of one height beside each other.
Image beside(const Image& left, const Image& right);

// How far a matte's edge lies from the edge that the picture itself shows. Does NOT need the mesh.

// For every place on the matte's edge where figure and background differ clearly in colour: how many pixels the matte's
// edge lies outside the picture's (negative: the matte is too small). `rgba`: alpha = matte. The figure's colour is
// taken from 4 to 7 pixels inside, the background's from as far outside, and the picture's edge is where linear light
// is half of each. Every `stride`-th pixel of the edge.
std::vector<double> matteEdgeOffsets(const Image& rgba, int stride);

}  // namespace fourdvt::refine
