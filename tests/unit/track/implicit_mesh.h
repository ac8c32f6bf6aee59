// SPDX-License-Identifier: Apache-2.0
// Closed meshes of implicit functions, by marching tetrahedra, with the slivers that these leave.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <utility>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::testing {

using Implicit = std::function<float(const glm::vec3&)>;  // below 0 inside

inline Implicit ball(const glm::vec3& centre, float radius) {
  return [=](const glm::vec3& p) { return glm::distance(p, centre) - radius; };
}

inline Implicit capsule(const glm::vec3& a, const glm::vec3& b, float radius) {
  return [=](const glm::vec3& p) {
    const float share = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0f, 1.0f);
    return glm::distance(p, glm::mix(a, b, share)) - radius;
  };
}

inline Implicit torus(float large_radius, float small_radius) {
  return [=](const glm::vec3& p) { return std::hypot(std::hypot(p.x, p.y) - large_radius, p.z) - small_radius; };
}

inline Implicit joint(const Implicit& a, const Implicit& b) {
  return [=](const glm::vec3& p) { return std::min(a(p), b(p)); };
}

// Meshes the zero level inside the box on a grid of `step_m`; closed where the box contains the whole inside.
inline TriangleMesh meshOf(const Implicit& inside, const glm::vec3& low, const glm::vec3& high, float step_m) {
  const glm::ivec3 count = glm::ivec3(glm::ceil((high - low) / step_m)) + 1;
  const auto number = [&](const glm::ivec3& at) { return uint64_t((at.z * count.y + at.y) * count.x + at.x); };
  const auto point = [&](const glm::ivec3& at) { return low + step_m * glm::vec3(at); };
  std::vector<float> values(size_t(count.x) * count.y * count.z);
  for (int z = 0; z < count.z; ++z)
    for (int y = 0; y < count.y; ++y)
      for (int x = 0; x < count.x; ++x) values[number({x, y, z})] = inside(point({x, y, z}));
  TriangleMesh mesh;
  std::map<std::pair<uint64_t, uint64_t>, uint32_t> cuts;
  const auto cut = [&](const glm::ivec3& a, const glm::ivec3& b) {
    const auto [entry, fresh] =
        cuts.emplace(std::minmax(number(a), number(b)), static_cast<uint32_t>(mesh.positions.size()));
    if (fresh) {
      const float va = values[number(a)], vb = values[number(b)];
      mesh.positions.push_back(glm::mix(point(a), point(b), std::clamp(va / (va - vb), 0.02f, 0.98f)));
    }
    return entry->second;
  };
  const auto tetrahedron = [&](const glm::ivec3(&corners)[4]) {
    std::vector<glm::ivec3> in, out;
    for (const glm::ivec3& c : corners) (values[number(c)] < 0 ? in : out).push_back(c);
    std::vector<uint32_t> loop;
    if (in.size() == 1 || out.size() == 1) {
      for (const glm::ivec3& a : in)
        for (const glm::ivec3& b : out) loop.push_back(cut(a, b));
    } else if (in.size() == 2) {
      loop = {cut(in[0], out[0]), cut(in[0], out[1]), cut(in[1], out[1]), cut(in[1], out[0])};
    }
    for (size_t k = 2; k < loop.size(); ++k) {
      glm::uvec3 face(loop[0], loop[k - 1], loop[k]);
      const glm::vec3 &a = mesh.positions[face.x], &b = mesh.positions[face.y], &c = mesh.positions[face.z];
      if (glm::dot(glm::cross(b - a, c - a), point(out[0]) - point(in[0])) < 0) std::swap(face.y, face.z);
      mesh.faces.push_back(face);
    }
  };
  const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int z = 0; z + 1 < count.z; ++z)
    for (int y = 0; y + 1 < count.y; ++y)
      for (int x = 0; x + 1 < count.x; ++x)
        for (const auto& order : orders) {  // along the cube's diagonal
          glm::ivec3 corners[4] = {{x, y, z}, {x, y, z}, {x, y, z}, {x, y, z}};
          for (int k = 1; k < 4; ++k) {
            corners[k] = corners[k - 1];
            corners[k][order[k - 1]] += 1;
          }
          tetrahedron(corners);
        }
  return mesh;
}

}  // namespace fourdvt::testing
