// SPDX-License-Identifier: Apache-2.0
// A box between two cameras, for tests of face costs and labels.
#pragma once

#include <vector>

#include "base/camera.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// Camera at `eye` that looks along `forward`.
inline PinholeCamera cameraAt(const glm::dvec3& eye, const glm::dvec3& forward) {
  const glm::dvec3 f = glm::normalize(forward), right = glm::normalize(glm::cross(f, glm::dvec3(0, 1, 0)));
  const glm::dvec3 down = glm::cross(f, right);
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, down, f));
  PinholeCamera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 50;
  camera.cam_from_world = glm::dmat4(rotation);
  camera.cam_from_world[3] = glm::dvec4(-(rotation * eye), 1);
  return camera;
}

// Unit cube round the origin, two triangles a side: faces 2k and 2k+1 have normal (+x, -x, +y, -y, +z, -z)[k].
struct Box {
  MeshTopology topology;
  Positions positions;
};

inline Box makeBox() {
  Box box;
  const glm::vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 6; ++k) {
    const glm::vec3 n = axes[k / 2] * (k % 2 ? -1.0f : 1.0f), u = axes[(k / 2 + 1) % 3], v = glm::cross(n, u);
    const uint32_t base = static_cast<uint32_t>(box.positions.size());
    for (glm::vec2 s : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
      box.positions.push_back(0.5f * (n + s.x * u + s.y * v));
    box.topology.face_vertices.push_back({base, base + 1, base + 2});
    box.topology.face_vertices.push_back({base, base + 2, base + 3});
  }
  box.topology.vertex_count = static_cast<uint32_t>(box.positions.size());
  return box;
}

// Camera 0 in front (+z), camera 1 at 30° from it towards +x.
inline std::vector<PinholeCamera> boxCameras() {
  return {cameraAt({0, 0, 5}, {0, 0, -1}), cameraAt({2.5, 0, 4.330127}, {-0.5, 0, -0.8660254})};
}

}  // namespace fourdvt::bake
