// SPDX-License-Identifier: Apache-2.0
// A person made of capsules that walks on the spot: a closed mesh of thousands of faces with label seams and chart
// seams, like captured characters.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "quad_scene.h"

namespace fourdvt::testing {

struct Mannequin {
  Scene scene;
  std::vector<int> limb_of_;  // per vertex

  // faces: approximate number. layers: filled from the nearest of `cameras` cameras in a ring.
  explicit Mannequin(int faces, int layers = 3, int cameras = 8) {
    scene.character.cameras.clear();
    for (int c = 0; c < cameras; ++c)
      scene.character.cameras.push_back(cameraFromOrbit({360.0 * c / cameras, 5, 3, {0, 0.85, 0}, 35}, 720, 960));
    const int round = std::max(6, int(std::sqrt(faces / 12.0 * 0.7))), rows = faces / 12 / round + 2;
    const auto limb = [&](glm::vec3 top, glm::vec3 bottom, float radius) {
      addCapsule(top, bottom, radius, round, rows);
    };
    limb({0, 1.45f, 0}, {0, 0.95f, 0}, 0.15f);           // trunk
    limb({0, 1.70f, 0}, {0, 1.62f, 0}, 0.09f);           // head
    limb({-0.09f, 0.9f, 0}, {-0.09f, 0.06f, 0}, 0.06f);  // legs, 6 cm apart
    limb({0.09f, 0.9f, 0}, {0.09f, 0.06f, 0}, 0.06f);    //
    limb({-0.21f, 1.4f, 0}, {-0.24f, 0.8f, 0}, 0.045f);  // arms, beside the trunk
    limb({0.21f, 1.4f, 0}, {0.24f, 0.8f, 0}, 0.045f);
    scene.finish();
    scene.setLayers(layers, 64);
    scene.labels = labels(0);
  }

  // Positions at `phase` of a step, radians; 0: standing.
  Positions posed(float phase) const {
    Positions out = scene.mesh.positions;
    for (size_t v = 0; v < out.size(); ++v) {
      const int limb = limb_of_[v];
      if (limb < 2) continue;
      const float hinge = limb < 4 ? 0.95f : 1.42f, side = limb % 2 ? 1 : -1, turn = side * 0.6f * std::sin(phase);
      const glm::vec2 p(out[v].z, out[v].y - hinge);
      out[v].z = std::cos(turn) * p.x - std::sin(turn) * p.y;
      out[v].y = std::sin(turn) * p.x + std::cos(turn) * p.y + hinge;
    }
    return out;
  }

  // Labels: the cameras nearest to each face's direction, turned by `shift` degrees.
  std::vector<uint8_t> labels(double shift) const {
    const MeshTopology& t = scene.mesh.topology;
    const int cameras = int(scene.character.cameras.size()), layers = scene.character.layer_count;
    std::vector<uint8_t> out(size_t(layers) * t.faceCount()), order(static_cast<size_t>(cameras));
    for (uint32_t f = 0; f < t.faceCount(); ++f) {
      const auto& v = t.face_vertices[f];
      const auto& p = scene.mesh.positions;
      const glm::dvec3 normal(glm::cross(p[v.y] - p[v.x], p[v.z] - p[v.x]));
      const double turn = glm::radians(shift);
      const glm::dvec3 towards(std::cos(turn) * normal.x + std::sin(turn) * normal.z, normal.y,
                               std::cos(turn) * normal.z - std::sin(turn) * normal.x);
      std::iota(order.begin(), order.end(), uint8_t(0));
      const auto facing = [&](uint8_t c) {
        return glm::dot(towards, scene.character.cameras[c].centreInWorld() - glm::dvec3(0, 0.85, 0));
      };
      std::sort(order.begin(), order.end(), [&](uint8_t a, uint8_t b) { return facing(a) > facing(b); });
      for (int layer = 0; layer < layers; ++layer) out[size_t(layer) * t.faceCount() + f] = order[layer];
    }
    return out;
  }

  // Waves that differ from layer to layer, RGBA.
  Image picture() const {
    Image image(scene.rendition.width, scene.rendition.height, 4, 255);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int k = 0; k < 3; ++k)
          image.at(x, y)[k] = uint8_t(126 + 60 * std::sin(0.5 * x + k) * std::cos(0.4 * y + 0.03 * x));
    return image;
  }

 private:
  // One chart per capsule: the first and last column of the grid share vertices, but not texture coordinates.
  void addCapsule(glm::vec3 top, glm::vec3 bottom, float radius, int round, int rows) {
    MeshTopology& t = scene.mesh.topology;
    const int limb = limb_of_.empty() ? 0 : limb_of_.back() + 1;
    if (limb == 0) scene.mesh.positions.clear(), t.uvs.clear(), t.face_vertices.clear(), t.face_uvs.clear();
    const uint32_t first = uint32_t(scene.mesh.positions.size()), first_uv = uint32_t(t.uvs.size());
    const auto add = [&](const glm::vec3& p) { scene.mesh.positions.push_back(p), limb_of_.push_back(limb); };
    const glm::vec3 axis = bottom - top;
    add(top + glm::vec3(0, radius, 0));
    for (int row = 1; row < rows; ++row) {
      // Round ends by the ring's radius, with the length in between.
      const float along = float(row) / rows, angle = float(M_PI) * along;
      const glm::vec3 centre = top + axis * (0.5f - 0.5f * std::cos(angle)) + glm::vec3(0, radius * std::cos(angle), 0);
      const float ring = radius * std::pow(std::sin(angle), 0.5f);
      for (int i = 0; i < round; ++i) {
        const float turn = 0.2f + 2 * float(M_PI) * float(i) / float(round);  // no label seam at the chart seam
        add(centre + ring * glm::vec3(std::sin(turn), 0, std::cos(turn)));
      }
    }
    add(bottom - glm::vec3(0, radius, 0));
    const uint32_t last = uint32_t(scene.mesh.positions.size()) - 1;
    for (int row = 0; row <= rows; ++row)
      for (int i = 0; i <= round; ++i)
        t.uvs.emplace_back((float(limb) + 0.05f + 0.9f * float(i) / float(round)) / 6,
                           0.05f + 0.9f * float(row) / float(rows));
    const auto vertex = [&](int row, int i) {
      return row == 0 ? first : row == rows ? last : first + 1 + uint32_t((row - 1) * round + i % round);
    };
    const auto uv = [&](int row, int i) { return first_uv + uint32_t(row * (round + 1) + i); };
    for (int row = 0; row < rows; ++row)
      for (int i = 0; i < round; ++i) {
        if (row + 1 < rows) {
          t.face_vertices.push_back({vertex(row, i), vertex(row + 1, i), vertex(row + 1, i + 1)});
          t.face_uvs.push_back({uv(row, i), uv(row + 1, i), uv(row + 1, i + 1)});
        }
        if (row > 0) {
          t.face_vertices.push_back({vertex(row, i), vertex(row + 1, i + 1), vertex(row, i + 1)});
          t.face_uvs.push_back({uv(row, i), uv(row + 1, i + 1), uv(row, i + 1)});
        }
      }
  }
};

}  // namespace fourdvt::testing
