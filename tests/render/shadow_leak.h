// SPDX-License-Identifier: Apache-2.0
// Share of a view that a camera textures through an occluder ("shadow leak", OVH03 5.2.2), and share that it sees but
// leaves untextured. Occlusion is computed with rays to the camera's centre, not with depth maps.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/camera.h"
#include "base/face_buffer.h"
#include "render/cameras/fvvr.h"

namespace fourdvt::testing {

// Surface points at a view's pixels, and their visibility in a camera.
struct ViewTruth {
  enum State : uint8_t {
    Nothing,
    Seen,
    Hidden,
    Between
  };  // Between: undecided, at a grazing angle, near a
      // contact, or with the camera more than 90 degrees aside
  std::vector<State> pixels;
};

// Faces by the tiles of a camera's picture that they overlap.
class FaceTiles {
 public:
  FaceTiles(const PinholeCamera& camera, const MeshTopology& topology, const Positions& positions)
      : camera_(camera), topology_(topology), positions_(positions), columns_(camera.width / kTile + 1) {
    tiles_.resize(size_t(columns_) * (camera.height / kTile + 1));
    for (uint32_t f = 0; f < topology.face_vertices.size(); ++f) {
      glm::dvec2 low(1e9), high(-1e9);
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p = camera.project(glm::dvec3(positions[topology.face_vertices[f][k]]));
        low = glm::min(low, glm::dvec2(p)), high = glm::max(high, glm::dvec2(p));
      }
      for (int y = tileOf(low.y, camera.height); y <= tileOf(high.y, camera.height); ++y)
        for (int x = tileOf(low.x, camera.width); x <= tileOf(high.x, camera.width); ++x)
          tiles_[size_t(y) * columns_ + x].push_back(f);
    }
  }
  // Share of the way from the camera to the point at which the ray crosses its first face; 1 if it crosses none.
  double firstCrossing(const glm::dvec3& point) const {
    const glm::dvec3 centre = camera_.centreInWorld(), ray = point - centre, pixel = camera_.project(point);
    double first = 1;
    for (const uint32_t f :
         tiles_[size_t(tileOf(pixel.y, camera_.height)) * columns_ + tileOf(pixel.x, camera_.width)]) {
      const glm::uvec3& face = topology_.face_vertices[f];
      const glm::dvec3 a(positions_[face.x]), u = glm::dvec3(positions_[face.y]) - a,
                                              v = glm::dvec3(positions_[face.z]) - a;
      const glm::dvec3 p = glm::cross(ray, v), s = centre - a, q = glm::cross(s, u);
      const double scale = glm::dot(u, p);
      if (scale == 0) continue;
      const double x = glm::dot(s, p) / scale, y = glm::dot(ray, q) / scale, t = glm::dot(v, q) / scale;
      if (x >= 0 && y >= 0 && x + y <= 1 && t > 0) first = std::min(first, t);
    }
    return first;
  }

 private:
  static constexpr int kTile = 16;
  static int tileOf(double pixel, int size) { return int(std::clamp(pixel, 0.0, size - 1.0)) / kTile; }
  const PinholeCamera& camera_;
  const MeshTopology& topology_;
  const Positions& positions_;
  int columns_ = 0;
  std::vector<std::vector<uint32_t>> tiles_;
};

// Minimum distance of an occluder in front of the point; and minimum cosine to the camera, below which a point is left
// out.
constexpr double kOccluder_m = 0.05, kFacing = 0.3;

inline ViewTruth truthOf(const PinholeCamera& view, const PinholeCamera& camera, const MeshTopology& topology,
                         const Positions& positions) {
  const FaceTiles tiles(camera, topology, positions);
  const FaceBuffer faces = rasterise(view, topology.face_vertices, positions, 1);
  const glm::dmat4 world_from_view = glm::inverse(view.cam_from_world);
  ViewTruth out{std::vector(faces.face.size(), ViewTruth::Nothing)};
  for (size_t i = 0; i < faces.face.size(); ++i) {
    if (faces.face[i] == ~0u) continue;
    out.pixels[i] = ViewTruth::Between;
    const double z = faces.depth_m[i], x = double(i % faces.width) + 0.5, y = double(i / faces.width) + 0.5;
    const glm::dvec3 point(world_from_view *
                           glm::dvec4((x - view.cx) / view.fx * z, (y - view.cy) / view.fy * z, z, 1));
    const glm::uvec3& face = topology.face_vertices[faces.face[i]];
    const glm::dvec3 a(positions[face.x]), b(positions[face.y]), c(positions[face.z]);
    const glm::dvec3 to_camera = camera.centreInWorld() - point;
    const double facing = glm::dot(glm::normalize(glm::cross(b - a, c - a)), glm::normalize(to_camera));
    if (facing < kFacing || glm::dot(to_camera, view.centreInWorld() - point) <= 0) continue;
    const double before_m = (1 - tiles.firstCrossing(point)) * glm::length(to_camera);
    if (before_m > kOccluder_m) out.pixels[i] = ViewTruth::Hidden;
    if (before_m < 1e-6) out.pixels[i] = ViewTruth::Seen;
  }
  return out;
}

struct Leak {
  size_t hidden = 0,
         leaked = 0;          // pixels that an occluder hides from the camera, and those that it textures all the same
  size_t seen = 0, lost = 0;  // pixels that the camera sees; those among them that it does not texture
  void operator+=(const Leak& o) { hidden += o.hidden, leaked += o.leaked, seen += o.seen, lost += o.lost; }
};

// Requires an opaque picture, so that a fragment is shown wherever the camera textures it.
inline Result<Leak> leakOf(gpu::Device& device, const PinholeCamera& view, const PinholeCamera& camera,
                           const MeshTopology& topology, const Positions& positions, const ViewTruth& truth,
                           const render::DepthMapOptions& maps) {
  FOURDVT_ASSIGN(const auto fvvr, render::Fvvr::create(device, {&camera, 1}, topology, maps));
  Image white(camera.width, camera.height, 4, 255);
  FOURDVT_TRY(fvvr->setFrame(positions, {&white, 1}));
  FOURDVT_ASSIGN(const Image image, fvvr->renderStill(render::viewFromCamera(view),
                                                      {.samples = 0, .unseen = render::Unseen::Transparent}));
  Leak out;
  for (size_t i = 0; i < truth.pixels.size(); ++i) {
    const bool textured = image.pixels[4 * i + 3] > 127;
    if (truth.pixels[i] == ViewTruth::Hidden) ++out.hidden, out.leaked += textured;
    if (truth.pixels[i] == ViewTruth::Seen) ++out.seen, out.lost += !textured;
  }
  return out;
}

// An arm in front of a body: a cylinder of radius 4 cm along x, and a wide one behind it along y, closed and faceted.
struct ArmScene {
  MeshTopology topology;
  Positions positions;
  ArmScene() {
    addCylinder({0, 1, 0}, {0, 1, 0}, {1, 0, 0}, 0.18, 0.5, 40, 20);
    addCylinder({0, 1, 0.35}, {1, 0, 0}, {0, 1, 0}, 0.04, 0.35, 24, 30);
    topology.vertex_count = uint32_t(positions.size());
  }

 private:
  void addCylinder(const glm::dvec3& centre, const glm::dvec3& axis, const glm::dvec3& side, double radius_m,
                   double half_m, uint32_t around, uint32_t rings) {
    const uint32_t first = uint32_t(positions.size());
    const glm::dvec3 third = glm::cross(axis, side);
    for (uint32_t r = 0; r <= rings; ++r)
      for (uint32_t k = 0; k < around; ++k) {
        const double angle = 2 * M_PI * k / around;
        positions.emplace_back(centre + axis * half_m * (2.0 * r / rings - 1) +
                               radius_m * (side * std::cos(angle) + third * std::sin(angle)));
      }
    const auto at = [&](uint32_t r, uint32_t k) { return first + r * around + k % around; };
    for (uint32_t r = 0; r < rings; ++r)
      for (uint32_t k = 0; k < around; ++k) {
        topology.face_vertices.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
        topology.face_vertices.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
      }
    for (const uint32_t r : {0u, rings}) {
      const uint32_t middle = uint32_t(positions.size());
      positions.emplace_back(centre + axis * half_m * (2.0 * r / rings - 1));
      for (uint32_t k = 0; k < around; ++k)
        topology.face_vertices.push_back(r == 0 ? glm::uvec3{middle, at(r, k + 1), at(r, k)}
                                                : glm::uvec3{middle, at(r, k), at(r, k + 1)});
    }
  }
};

}  // namespace fourdvt::testing
