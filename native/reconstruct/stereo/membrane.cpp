// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/membrane.h"

#include <algorithm>
#include <unordered_map>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kVoxels = kBlock * kBlock * kBlock;
using Blocks = std::vector<BlockValues>;

// Which blocks lie beside each block: −x, +x, −y, +y, −z, +z; -1: none.
class Neighbours {
 public:
  explicit Neighbours(const SparseDistance& distance) : beside_(distance.blocks.size()) {
    std::unordered_map<uint64_t, int> index;
    for (size_t b = 0; b < distance.blocks.size(); ++b) index[blockKey(distance.blocks[b].at)] = int(b);
    for (size_t b = 0; b < distance.blocks.size(); ++b)
      for (int k = 0; k < 6; ++k) {
        glm::ivec3 at = distance.blocks[b].at;
        at[k / 2] += k % 2 ? kBlock : -kBlock;
        const auto found = index.find(blockKey(at));
        beside_[b][k] = found == index.end() ? -1 : found->second;
      }
  }
  // The six values round voxel i of a block; `none` where there is no block.
  std::array<float, 6> round(const Blocks& blocks, size_t block, int i, float none) const {
    const std::array<float, kVoxels>& here = blocks[block];
    std::array<float, 6> out;
    for (int axis = 0; axis < 3; ++axis) {
      const int stride = kBlock * kBlock >> 3 * axis, place = i / stride % kBlock, across = (kBlock - 1) * stride;
      const auto beyond = [&](int k, int voxel) {
        return beside_[block][k] < 0 ? none : blocks[beside_[block][k]][voxel];
      };
      out[2 * axis] = place > 0 ? here[i - stride] : beyond(2 * axis, i + across);
      out[2 * axis + 1] = place < kBlock - 1 ? here[i + stride] : beyond(2 * axis + 1, i - across);
    }
    return out;
  }

 private:
  std::vector<std::array<int, 6>> beside_;
};

// New values of all voxels from those of the round before.
template <class Rule>
void update(Blocks& blocks, Blocks& next, const Rule& rule) {
  inParallel(blocks.size(), [&](int b) {
    for (int i = 0; i < kVoxels; ++i) next[b][i] = rule(size_t(b), i);
  });
  std::swap(blocks, next);
}

Blocks valuesOf(const SparseDistance& distance) {
  Blocks out;
  for (const SparseDistance::Block& block : distance.blocks) out.push_back(block.values);
  return out;
}

// 1 where the hull is thick: a voxel as deep as the band is near; else 0.
Blocks thickOf(const Blocks& hull, const Neighbours& neighbours, float band_m, int reach) {
  Blocks thick = hull, next = hull;
  for (BlockValues& block : thick)
    for (float& value : block) value = value >= 0.99f * band_m;
  for (int step = 0; step < reach; ++step)
    update(thick, next, [&](size_t b, int i) {
      const std::array<float, 6> round = neighbours.round(thick, b, i, 0);
      return std::max(thick[b][i], *std::max_element(round.begin(), round.end()));
    });
  return thick;
}

// How near maps know something: 1 up to half of `reach` steps away, 0 beyond it.
Blocks evidenceOf(std::span<const BlockValues> trust, const Neighbours& neighbours, int reach) {
  Blocks near(trust.begin(), trust.end());
  for (BlockValues& block : near)
    for (float& value : block) value = value > 0 ? 2.0f : 0.0f;
  Blocks next = near;
  const float step = 2.0f / float(reach);
  for (int k = 0; k < reach; ++k)
    update(near, next, [&](size_t b, int i) {
      const std::array<float, 6> round = neighbours.round(near, b, i, 0);
      return std::max(near[b][i], *std::max_element(round.begin(), round.end()) - step);
    });
  return near;
}

}  // namespace

void spanMembrane(const SparseDistance& hull, std::span<const BlockValues> trust, const MembraneOptions& options,
                  SparseDistance& distance) {
  if (options.stiffness <= 0) return;
  const Neighbours neighbours(hull);
  const float band = hull.band_m, stiffness = float(options.stiffness);
  const Blocks limits = valuesOf(hull), measured = valuesOf(distance),
               thick = thickOf(limits, neighbours, band, options.thin_voxels);
  Blocks values = measured, next = measured;
  for (int round = 0; round < options.rounds; ++round)
    update(values, next, [&](size_t b, int i) {
      const float limit = limits[b][i], known = trust[b][i];
      if (limit <= -band || (known <= 0 && thick[b][i] == 0)) return limit;
      const std::array<float, 6> near = neighbours.round(values, b, i, -band);
      const float sum = near[0] + near[1] + near[2] + near[3] + near[4] + near[5];
      const float value = (known * measured[b][i] + stiffness * sum) / (known + 6 * stiffness);
      return std::min(known > 0 ? std::max(value, measured[b][i]) : value, limit);
    });
  if (options.reach_voxels > 0) {
    const Blocks near = evidenceOf(trust, neighbours, options.reach_voxels);
    for (size_t b = 0; b < values.size(); ++b)
      for (int i = 0; i < kVoxels; ++i)
        values[b][i] = limits[b][i] + std::clamp(near[b][i], 0.0f, 1.0f) * (values[b][i] - limits[b][i]);
  }
  for (size_t b = 0; b < values.size(); ++b) distance.blocks[b].values = values[b];
}

}  // namespace fourdvt::reconstruct
