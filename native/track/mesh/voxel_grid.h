// SPDX-License-Identifier: Apache-2.0
// Dense grid of voxels around a surface, for digital topology.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::track {

// Voxels are points origin_in_world + voxel_m * (x, y, z); values of one lie at index(). x runs fastest. The outermost
// voxels have no neighbours in around() and facing(): they belong to the background.
struct VoxelGrid {
  // Grid around `box` with `margin` voxels on all sides, >= 2.
  VoxelGrid(const BoundingBox& box, double voxel, int margin)
      : voxel_m(voxel),
        // An odd fraction of a voxel keeps grid lines off vertices at round coordinates.
        origin_in_world(glm::dvec3(box.min) - voxel * (double(margin) + glm::dvec3(0.3183, 0.2718, 0.1618))),
        size(glm::ivec3(glm::ceil((glm::dvec3(box.max) - glm::dvec3(box.min)) / voxel)) + 2 * margin + 1) {}

  double voxel_m;
  glm::dvec3 origin_in_world;
  glm::ivec3 size;

  size_t count() const { return size_t(size.x) * size_t(size.y) * size_t(size.z); }
  size_t step(int axis) const { return axis == 0 ? 1 : axis == 1 ? size_t(size.x) : size_t(size.x) * size_t(size.y); }
  size_t index(const glm::ivec3& at) const {
    return (size_t(at.z) * size_t(size.y) + size_t(at.y)) * size_t(size.x) + size_t(at.x);
  }
  glm::ivec3 place(size_t i) const {
    return {int(i % size_t(size.x)), int(i / size_t(size.x) % size_t(size.y)), int(i / step(2))};
  }
  glm::dvec3 inGrid(const glm::vec3& point) const { return (glm::dvec3(point) - origin_in_world) / voxel_m; }
  glm::vec3 inWorld(const glm::ivec3& at) const { return glm::vec3(origin_in_world + voxel_m * glm::dvec3(at)); }

  bool isOutermost(const glm::ivec3& at) const {
    return glm::any(glm::lessThan(at, glm::ivec3(1))) || glm::any(glm::greaterThan(at, size - 2));
  }

  // Calls visit(index, place) for the 26 neighbours; place: (z+1) * 9 + (y+1) * 3 + x+1.
  template <class Visit>
  void around(size_t i, const Visit& visit) const {
    if (isOutermost(place(i))) return;
    for (int p = 0; p < 27; ++p) {
      if (p == 13) continue;
      visit(size_t(int64_t(i) + (p / 9 - 1) * int64_t(step(2)) + (p / 3 % 3 - 1) * int64_t(step(1)) + p % 3 - 1), p);
    }
  }

  // Calls visit(index) for the neighbours across faces.
  template <class Visit>
  void facing(size_t i, const Visit& visit) const {
    const glm::ivec3 at = place(i);
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] > 0) visit(i - step(axis));
      if (at[axis] < size[axis] - 1) visit(i + step(axis));
    }
  }

  // True where a voxel at most `reach` away along each axis has the other value.
  bool nearBorder(const std::vector<uint8_t>& inside, const glm::ivec3& at, int reach) const {
    const glm::ivec3 low = glm::max(at - reach, glm::ivec3(0)), high = glm::min(at + reach, size - 1);
    const uint8_t here = inside[index(at)];
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          if (inside[index({x, y, z})] != here) return true;
    return false;
  }

  // [voxel] distance from the outside, voxels, by chamfers of the 26 neighbours; 0 outside.
  std::vector<float> depths(const std::vector<uint8_t>& inside) const {
    std::vector<float> out(count(), 0);
    for (size_t i = 0; i < out.size(); ++i) out[i] = inside[i] ? 1e9f : 0.f;
    const auto sweep = [&](size_t i, bool forward) {
      if (!inside[i]) return;
      around(i, [&](size_t n, int p) {
        if ((n < i) != forward) return;
        const int axes = (p % 3 != 1) + (p / 3 % 3 != 1) + (p / 9 != 1);
        out[i] = std::min(out[i], out[n] + std::sqrt(float(axes)));
      });
    };
    for (size_t i = 0; i < out.size(); ++i) sweep(i, true);
    for (size_t i = out.size(); i-- > 0;) sweep(i, false);
    return out;
  }

  // Voxels of the mask that are connected with `seed` across faces.
  std::vector<uint8_t> component(const std::vector<uint8_t>& mask, size_t seed) const {
    std::vector<uint8_t> out(count(), 0);
    std::vector<size_t> open{seed};
    out[seed] = 1;
    while (!open.empty()) {
      const size_t i = open.back();
      open.pop_back();
      facing(i, [&](size_t n) {
        if (!mask[n] || out[n]) return;
        out[n] = 1;
        open.push_back(n);
      });
    }
    return out;
  }
};

}  // namespace fourdvt::track
