// SPDX-License-Identifier: Apache-2.0
// Artefacts of the texture atlas in a rendered view: contrast along chart seams, and backdrop green at silhouettes.
// Needs no truth picture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::measure {

// Mesh edge whose two faces have different UVs along it.
struct ChartSeam {
  uint32_t vertex_a, vertex_b;
  uint32_t face_a, face_b;
};
std::vector<ChartSeam> chartSeams(const MeshTopology& topology);

// Sampled every pixel along the visible seams. The contrast at a point with unit normal n across the edge and luma L
// (0..255): |L(1.5n) - L(-1.5n)| + |L(0) - (L(1.5n) + L(-1.5n)) / 2|, a step and a line. Controls: the same along
// parallel lines 6 pixels to either side, on the same surface.
struct SeamContrast {
  double seam = 0, control = 0;  // means, levels
  size_t samples = 0;
  double visible() const { return seam - control; }  // 0: seams match their surroundings
};
struct SeamOptions {
  double min_angle_deg = 0;  // between view ray and the normals of both faces; 60 selects grazing views
};
// `picture`: RGB(A) of the view's size.
SeamContrast seamContrast(const Image& picture, const PinholeCamera& view, const MeshTopology& topology,
                          const Positions& positions, const SeamOptions& options = {});

// Share (0..1) of the pixels within 3 pixels of the silhouette (alpha 128) of a straight-alpha RGBA picture that are
// tinted by `backdrop` (sRGB 0..255, green or blue). A colour's tint is the excess of the backdrop's strongest channel
// over the other two. A pixel counts if its tint is at least a quarter of the way from the strongest tint of the
// performer nearby, 5 to 9 pixels inside, to that of the backdrop. NaN without a silhouette.
double fringeShare(const Image& rgba, const glm::dvec3& backdrop);

}  // namespace fourdvt::measure
