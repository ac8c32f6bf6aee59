// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/depth_fusion.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <unordered_map>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr float kOneSurface_m = 0.03f;  // maximum depth difference of neighbouring pixels on one surface

// Signed distance of a point to a map's surface, metres along the optical axis, positive behind it.
struct Evidence {
  float distance = 0, weight = 0;
};

class MapAtPoint {
 public:
  explicit MapAtPoint(const DepthMap& map) : map_(map) {
    glm::dmat4 k(1.0);
    k[0][0] = map.camera.fx, k[1][1] = map.camera.fy;
    k[2][0] = map.camera.cx - map.x, k[2][1] = map.camera.cy - map.y;
    pixel_from_world_ = glm::mat4(k * map.camera.cam_from_world);
  }
  // False where the map has no depth.
  bool at(const glm::vec3& point, float truncation, Evidence& out) const {
    const glm::vec3 p(pixel_from_world_ * glm::vec4(point, 1));
    if (p.z <= 0) return false;
    const float x = p.x / p.z - 0.5f, y = p.y / p.z - 0.5f;
    if (!(x >= 0 && y >= 0 && x < map_.width - 1 && y < map_.height - 1)) return false;
    const int x0 = int(x), y0 = int(y);
    const float fx = x - x0, fy = y - y0;
    const size_t i = size_t(y0) * map_.width + x0;
    const size_t near = i + (fx > 0.5f) + (fy > 0.5f ? map_.width : 0);
    const float nearest = map_.depth_m[near];
    if (nearest <= 0) return false;
    // Bilinear if the four depths belong to one surface.
    const float d[4] = {map_.depth_m[i], map_.depth_m[i + 1], map_.depth_m[i + map_.width],
                        map_.depth_m[i + map_.width + 1]};
    const float low = std::min(std::min(d[0], d[1]), std::min(d[2], d[3])),
                high = std::max(std::max(d[0], d[1]), std::max(d[2], d[3]));
    float z = nearest;
    if (low > 0 && high - low < kOneSurface_m)
      z = (d[0] * (1 - fx) + d[1] * fx) * (1 - fy) + (d[2] * (1 - fx) + d[3] * fx) * fy;
    out.distance = p.z - z;
    if (out.distance > truncation) return false;
    out.distance = std::max(out.distance, -truncation);
    out.weight = map_.weight[near];
    return out.weight > 0;
  }

 private:
  const DepthMap& map_;
  glm::mat4 pixel_from_world_;
};

// Weighted median of n > 0 values.
float median(Evidence* e, int n, float total) {
  std::sort(e, e + n, [](const Evidence& a, const Evidence& b) { return a.distance < b.distance; });
  float sum = 0;
  for (int k = 0; k < n; ++k) {
    sum += e[k].weight;
    if (sum >= 0.5f * total) return e[k].distance;
  }
  return e[n - 1].distance;
}

// Fuses the hull's distance `hull_m` at a point with those of the maps: their mean near the median. `trust`: total
// weight of the maps, 0 if below the minimum.
float fused(const std::vector<MapAtPoint>& maps, const glm::vec3& point, float hull_m, const FusionOptions& options,
            std::vector<Evidence>& evidence, float& trust) {
  const float truncation = float(options.truncation_m), stays = float(options.hull_stays_m);
  int n = 0;
  float total = 0;
  for (const MapAtPoint& map : maps)
    if (map.at(point, truncation, evidence[n])) total += evidence[n++].weight;
  if (total <= options.min_weight) return hull_m;
  const float middle = median(evidence.data(), n, total);
  float sum = 0, weight = 0;
  for (int k = 0; k < n; ++k) {
    if (std::abs(evidence[k].distance - middle) > 0.5f * truncation) continue;
    sum += evidence[k].weight * evidence[k].distance, weight += evidence[k].weight;
  }
  trust = total;
  const float deeper = std::max(hull_m - sum / weight, 0.0f);
  return hull_m - deeper * std::clamp((deeper - stays) / (2 * stays), 0.0f, 1.0f);
}

}  // namespace

FusedDistance fuseDepths(const SparseDistance& hull, std::span<const DepthMap> maps, const FusionOptions& options) {
  std::vector<MapAtPoint> at;
  for (const DepthMap& map : maps)
    if (map.width > 0) at.emplace_back(map);
  FusedDistance out{withValuesInside(hull), {}};
  out.trust.resize(out.distance.blocks.size());
  cv::parallel_for_(cv::Range(0, int(out.distance.blocks.size())), [&](const cv::Range& range) {
    std::vector<Evidence> evidence(at.size());
    for (int b = range.start; b < range.end; ++b) {
      SparseDistance::Block& block = out.distance.blocks[b];
      for (int i = 0; i < int(block.values.size()); ++i) {
        float& value = block.values[i];
        out.trust[b][i] = 0;
        if (value <= -hull.band_m) continue;
        const glm::vec3 point(hull.origin_in_world + glm::dvec3(voxelOf(block, i)) * hull.voxel_m);
        value = std::clamp(fused(at, point, value, options, evidence, out.trust[b][i]), -hull.band_m, hull.band_m);
      }
    }
  });
  return out;
}

namespace {

constexpr int kVoxels = kBlock * kBlock * kBlock;
using Blocks = std::vector<BlockValues>;

// Indices of the adjacent blocks: −x, +x, −y, +y, −z, +z; -1: none.
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
  // Values of the six neighbours of voxel i; `none` outside the blocks.
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

// Updates all voxels from the values of the previous round.
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

// Mask of thick parts: 1 near a voxel at least as deep as the band, else 0.
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

// Proximity of depth data: 1 up to half of `reach` steps away, 0 beyond it.
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

namespace {

constexpr int kMask = kBlock - 1;

size_t valueIndex(const glm::ivec3& voxel) {
  return size_t(voxel.x & kMask) << 6 | size_t(voxel.y & kMask) << 3 | size_t(voxel.z & kMask);
}

uint64_t mixed(uint64_t key) { return (key ^ key >> 29) * 0x9e3779b97f4a7c15ull >> 20; }

}  // namespace

BlockIndex::BlockIndex(std::span<const SparseDistance::Block> blocks) {
  size_t size = 16;
  while (size < 2 * blocks.size()) size *= 2;
  slots_.resize(size);
  mask_ = size - 1;
  for (size_t b = 0; b < blocks.size(); ++b) {
    const uint64_t key = blockKey(blocks[b].at);
    size_t at = mixed(key) & mask_;
    while (slots_[at].block >= 0) at = (at + 1) & mask_;
    slots_[at] = {key, int(b)};
  }
}

int BlockIndex::find(const glm::ivec3& voxel) const {
  const uint64_t key = blockKey(glm::ivec3(voxel.x & ~kMask, voxel.y & ~kMask, voxel.z & ~kMask));
  for (size_t at = mixed(key) & mask_; slots_[at].block >= 0; at = (at + 1) & mask_)
    if (slots_[at].key == key) return slots_[at].block;
  return -1;
}

float DistanceSampler::voxel(const glm::ivec3& at) const {
  const int block = index_.find(at);
  return block < 0 ? -distance_.band_m : distance_.blocks[block].values[valueIndex(at)];
}

float DistanceSampler::at(const glm::dvec3& point_in_world) const {
  const glm::dvec3 in_grid = (point_in_world - distance_.origin_in_world) * per_voxel_;
  const glm::ivec3 low(glm::floor(in_grid));
  const glm::vec3 f(in_grid - glm::dvec3(low));
  float v[8];
  if ((low.x & kMask) < kMask && (low.y & kMask) < kMask && (low.z & kMask) < kMask) {
    const int block = index_.find(low);
    if (block < 0) return -distance_.band_m;
    const float* from = &distance_.blocks[block].values[valueIndex(low)];
    for (int k = 0; k < 8; ++k) v[k] = from[(k >> 2) * 64 + (k >> 1 & 1) * 8 + (k & 1)];
  } else {
    for (int k = 0; k < 8; ++k) v[k] = voxel(low + glm::ivec3(k >> 2, k >> 1 & 1, k & 1));
  }
  for (int k = 0; k < 4; ++k) v[k] += f.x * (v[k + 4] - v[k]);
  for (int k = 0; k < 2; ++k) v[k] += f.y * (v[k + 2] - v[k]);
  return v[0] + f.z * (v[1] - v[0]);
}

}  // namespace fourdvt::reconstruct
