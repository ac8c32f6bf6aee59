// SPDX-License-Identifier: Apache-2.0
// Hand-made characters for analytic tests: a quad in the plane z = 0 facing +Z, and a box on the ground.
#pragma once

#include <array>

#include "../unit/look_at.h"
#include "render/plain_figure.h"

namespace fourdvt::testing {

struct Scene {
  package::Character character;
  package::BaseMesh mesh;
  package::Rendition rendition;
  std::vector<uint8_t> labels;  // planar

  void setLayers(int count, int side) {
    character.layer_count = count;
    rendition.width = side * count;
    rendition.height = side;
    rendition.layers.clear();
    for (int layer = 0; layer < count; ++layer) rendition.layers.push_back({side * layer, 0, side, side});
    labels.assign(static_cast<size_t>(count) * mesh.topology.faceCount(), package::kNoCamera);
  }
  void setLabel(int rank, uint32_t face, uint8_t camera) { labels[rank * mesh.topology.faceCount() + face] = camera; }
  void finish() {
    mesh.topology.vertex_count = static_cast<uint32_t>(mesh.positions.size());
    character.vertex_count = mesh.topology.vertex_count;
    character.face_count = mesh.topology.faceCount();
    character.bounds = {mesh.positions[0], mesh.positions[0]};
    for (const glm::vec3& p : mesh.positions) {
      character.bounds.min = glm::min(character.bounds.min, p);
      character.bounds.max = glm::max(character.bounds.max, p);
    }
  }
};

// Corners (centre ± half) in the plane z = 0; face 0 is top left – bottom left – bottom right, face 1 the rest.
// UV (0,0) is the top left corner.
inline Scene quadScene(const glm::vec2& centre, float half) {
  Scene scene;
  scene.mesh.positions = {{centre.x - half, centre.y + half, 0},
                          {centre.x - half, centre.y - half, 0},
                          {centre.x + half, centre.y - half, 0},
                          {centre.x + half, centre.y + half, 0}};
  scene.mesh.topology.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  scene.mesh.topology.face_vertices = {{0, 1, 2}, {0, 2, 3}};
  scene.mesh.topology.face_uvs = scene.mesh.topology.face_vertices;
  scene.character.cameras = {lookAt({-1.5, 1.4, 3}, {0, 1, 0}, 64, 64, 60),
                             lookAt({2, 0.6, 2.5}, {0, 1, 0}, 64, 64, 60),
                             lookAt({0.2, 2.5, 2}, {0, 1, 0}, 64, 64, 60)};
  scene.finish();
  return scene;
}

// Closed box x, z in ±half_m, y in 0..height_m.
inline Scene boxScene(float half_m, float height_m) {
  Scene scene = quadScene({0, 0}, 1);
  scene.mesh.positions.clear();
  for (int i = 0; i < 8; ++i)
    scene.mesh.positions.push_back({i & 1 ? half_m : -half_m, i & 2 ? height_m : 0, i & 4 ? half_m : -half_m});
  scene.mesh.topology.face_vertices = {{4, 5, 7}, {4, 7, 6}, {1, 0, 2}, {1, 2, 3}, {5, 1, 3}, {5, 3, 7},
                                       {0, 4, 6}, {0, 6, 2}, {6, 7, 3}, {6, 3, 2}, {0, 1, 5}, {0, 5, 4}};
  scene.mesh.topology.face_uvs.assign(12, glm::uvec3(0, 1, 2));
  scene.finish();
  return scene;
}

}  // namespace fourdvt::testing
