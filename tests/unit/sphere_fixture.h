// SPDX-License-Identifier: Apache-2.0
// A ball in front of a ring of cameras: meshes that are too large or too small, and analytic mattes.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "base/camera.h"
#include "refine/outline.h"

namespace fourdvt::refine {

constexpr double kBallRadius_m = 0.5, kBallDistance_m = 4;
constexpr int kBallPicture = 480;  // pixels a side
constexpr double kBallFocal = 1500;

struct BallMesh {
  std::vector<glm::uvec3> faces;
  Positions positions;
  std::vector<glm::vec3> normals;
  std::vector<InnerEdge> edges;
};

// Icosahedron subdivided `splits` times: 2562 vertices for 4. All vertices lie on the ball.
inline BallMesh ballMesh(double radius, int splits = 4) {
  BallMesh mesh;
  const float g = (1 + std::sqrt(5.0f)) / 2;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int split = 0; split < splits; ++split) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& f : mesh.faces) {
      glm::uvec3 m;
      for (int k = 0; k < 3; ++k) {
        const auto [at, fresh] = middles.emplace(std::minmax(f[k], f[(k + 1) % 3]), uint32_t(mesh.positions.size()));
        if (fresh) mesh.positions.push_back(mesh.positions[f[k]] + mesh.positions[f[(k + 1) % 3]]);
        m[k] = at->second;
      }
      finer.insert(finer.end(), {{f.x, m.x, m.z}, {f.y, m.y, m.x}, {f.z, m.z, m.y}, m});
    }
    for (glm::vec3& p : mesh.positions) p = glm::normalize(p);
    mesh.faces = std::move(finer);
  }
  for (glm::vec3& p : mesh.positions) p *= float(radius) / glm::length(p);
  computeVertexNormals(mesh.faces, mesh.positions.data(), mesh.positions.size(), mesh.normals);
  mesh.edges = innerEdges(mesh.faces);
  return mesh;
}

// Camera `index` of `count` on a ring, looking slightly down.
inline PinholeCamera ballCamera(int index, int count) {
  PinholeCamera camera = cameraFromOrbit({.azimuth_deg = 360.0 * index / count,
                                          .elevation_deg = index % 2 ? 25.0 : -15.0,
                                          .distance_m = kBallDistance_m,
                                          .target_in_world = {0, 0, 0}},
                                         kBallPicture, kBallPicture);
  camera.fx = camera.fy = kBallFocal;
  camera.name = "cam" + std::to_string(index);
  return camera;
}

// Matte of the true ball, enlarged by `grown_pixels`: a disc, since the camera looks at the ball's centre.
inline MatteCrop ballMatte(double grown_pixels = 0) {
  const double radius =
      kBallFocal * kBallRadius_m / std::sqrt(kBallDistance_m * kBallDistance_m - kBallRadius_m * kBallRadius_m) +
      grown_pixels;
  MatteCrop matte;
  matte.alpha = Image(kBallPicture, kBallPicture, 1);
  for (int y = 0; y < kBallPicture; ++y)
    for (int x = 0; x < kBallPicture; ++x) {
      const double inside = radius - std::hypot(x + 0.5 - kBallPicture / 2.0, y + 0.5 - kBallPicture / 2.0);
      *matte.alpha.at(x, y) = uint8_t(std::lround(255 * std::clamp(inside + 0.5, 0.0, 1.0)));
    }
  return matte;
}

inline double medianResidual(const std::vector<OutlinePoint>& points) {
  std::vector<float> sorted;
  for (const OutlinePoint& s : points) sorted.push_back(s.residual_pixels);
  std::nth_element(sorted.begin(), sorted.begin() + long(sorted.size() / 2), sorted.end());
  return sorted[sorted.size() / 2];
}

}  // namespace fourdvt::refine
