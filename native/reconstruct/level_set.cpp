// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/level_set.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>

namespace fourdvt::reconstruct {

TriangleMesh zeroSurface(const SparseDistance& distance, double adaptivity) {
  openvdb::initialize();
  // OpenVDB's level sets are negative inside.
  auto grid = openvdb::FloatGrid::create(distance.band_m);
  auto& tree = grid->tree();
  using Leaf = openvdb::FloatTree::LeafNodeType;
  static_assert(Leaf::DIM == kBlock);
  const auto coordOf = [](const glm::ivec3& at) { return openvdb::Coord(at.x, at.y, at.z); };
  for (const SparseDistance::Block& block : distance.blocks) {
    auto* leaf = new Leaf(coordOf(block.at), distance.band_m, true);  // owned by the tree
    for (size_t i = 0; i < block.values.size(); ++i) leaf->setValueOnly(openvdb::Index(i), -block.values[i]);
    tree.addLeaf(leaf);
  }
  for (const glm::ivec3& at : distance.inside) tree.addTile(1, coordOf(at), -distance.band_m, true);

  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads, 0.0, adaptivity);
  TriangleMesh mesh;
  mesh.positions.reserve(points.size());
  for (const auto& p : points) {
    const glm::dvec3 in_grid(p.x(), p.y(), p.z());
    mesh.positions.push_back(glm::vec3(distance.origin_in_world + in_grid * distance.voxel_m));
  }
  mesh.faces.reserve(triangles.size() + 2 * quads.size());
  for (const auto& t : triangles) mesh.faces.emplace_back(t[0], t[1], t[2]);
  const auto length = [&](uint32_t a, uint32_t b) { return glm::distance(mesh.positions[a], mesh.positions[b]); };
  for (const auto& q : quads) {
    if (length(q[0], q[2]) <= length(q[1], q[3])) {
      mesh.faces.emplace_back(q[0], q[1], q[2]);
      mesh.faces.emplace_back(q[0], q[2], q[3]);
    } else {
      mesh.faces.emplace_back(q[0], q[1], q[3]);
      mesh.faces.emplace_back(q[1], q[2], q[3]);
    }
  }
  return mesh;
}

SparseDistance withValuesInside(const SparseDistance& distance) {
  SparseDistance out = distance;
  for (const glm::ivec3& at : distance.inside) {
    SparseDistance::Block& block = out.blocks.emplace_back();
    block.at = at;
    block.values.fill(distance.band_m);
  }
  out.inside.clear();
  return out;
}

void compact(SparseDistance& distance) {
  std::vector<SparseDistance::Block> crossed;
  for (const SparseDistance::Block& block : distance.blocks) {
    const auto [low, high] = std::minmax_element(block.values.begin(), block.values.end());
    if (*low >= distance.band_m)
      distance.inside.push_back(block.at);
    else if (*high > -distance.band_m)
      crossed.push_back(block);
  }
  distance.blocks = std::move(crossed);
}

}  // namespace fourdvt::reconstruct
