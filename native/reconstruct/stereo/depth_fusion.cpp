// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/depth_fusion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core/utility.hpp>
#include <unordered_map>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr float kOneSurface_m = 0.03f;  // maximum depth difference of neighbouring pixels on one surface
constexpr double kRounding_m = 1e-3;    // exceeds the rounding of depths to float

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
    across_ = (map.width + kTile - 1) / kTile, down_ = (map.height + kTile - 1) / kTile;
    farthest_.assign(size_t(across_) * down_, 0);
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x) {
        float& farthest = farthest_[size_t(y / kTile) * across_ + x / kTile];
        farthest = std::max(farthest, map.depth_m[size_t(y) * map.width + x]);
      }
  }
  // False if at() is false for all points of a sphere.
  bool mayHold(const glm::dvec3& centre, double radius, float truncation) const {
    const glm::dvec3 p = map_.camera.project(centre);
    const double nearest = p.z - radius;
    if (nearest <= 0) return p.z > -radius;
    const double slant =
        std::hypot((p.x - map_.camera.cx) / map_.camera.fx, (p.y - map_.camera.cy) / map_.camera.fy, 1.0);
    const double reach = slant * std::max(map_.camera.fx, map_.camera.fy) * radius / nearest + 2;
    const auto tile = [](double pixel, int count) {
      return int(std::clamp(std::floor(pixel / kTile), 0.0, double(count)));
    };
    const double x = p.x - map_.x, y = p.y - map_.y;
    for (int row = tile(y - reach, down_); row < tile(y + reach + kTile, down_); ++row)
      for (int column = tile(x - reach, across_); column < tile(x + reach + kTile, across_); ++column) {
        const float farthest = farthest_[size_t(row) * across_ + column];
        if (farthest > 0 && nearest < farthest + truncation + kRounding_m) return true;
      }
    return false;
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
  static constexpr int kTile = 8;  // pixels
  const DepthMap& map_;
  glm::mat4 pixel_from_world_;
  int across_ = 0, down_ = 0;
  std::vector<float> farthest_;  // [tile] maximum depth
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
float fused(std::span<const MapAtPoint* const> maps, const glm::vec3& point, float hull_m, const FusionOptions& options,
            std::vector<Evidence>& evidence, float& trust) {
  const float truncation = float(options.truncation_m), stays = float(options.hull_stays_m);
  int n = 0;
  float total = 0;
  for (const MapAtPoint* map : maps)
    if (map->at(point, truncation, evidence[n])) total += evidence[n++].weight;
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
    std::vector<const MapAtPoint*> near;
    for (int b = range.start; b < range.end; ++b) {
      SparseDistance::Block& block = out.distance.blocks[b];
      const glm::dvec3 centre = hull.origin_in_world + (glm::dvec3(block.at) + 0.5 * (kBlock - 1)) * hull.voxel_m;
      const double radius = std::sqrt(0.75) * kBlock * hull.voxel_m;
      near.clear();
      for (const MapAtPoint& map : at)
        if (map.mayHold(centre, radius, float(options.truncation_m))) near.push_back(&map);
      for (int i = 0; i < int(block.values.size()); ++i) {
        float& value = block.values[i];
        out.trust[b][i] = 0;
        if (value <= -hull.band_m) continue;
        const glm::vec3 point(hull.origin_in_world + glm::dvec3(voxelOf(block, i)) * hull.voxel_m);
        value = std::clamp(fused(near, point, value, options, evidence, out.trust[b][i]), -hull.band_m, hull.band_m);
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
  const std::array<int, 6>& of(size_t block) const { return beside_[block]; }

 private:
  std::vector<std::array<int, 6>> beside_;
};

// A block's values with those of the adjacent blocks' adjoining voxels.
class Padded {
 public:
  static constexpr int kSide = kBlock + 2, kStrides[3] = {kSide * kSide, kSide, 1};
  // `none`: value outside the blocks.
  Padded(const Blocks& blocks, const Neighbours& neighbours, size_t block, float none) {
    for (int x = 0; x < kBlock; ++x)
      for (int y = 0; y < kBlock; ++y) std::copy_n(&blocks[block][(x * kBlock + y) * kBlock], kBlock, at(x, y));
    for (int k = 0; k < 6; ++k) {
      const int axis = k / 2, other = neighbours.of(block)[k], stride = kBlock * kBlock >> 3 * axis;
      const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;  // the axes along the face
      const float* from = other < 0 ? nullptr : &blocks[other][k % 2 ? 0 : (kBlock - 1) * stride];
      float* to = at(0, 0) + (k % 2 ? kBlock : -1) * kStrides[axis];
      for (int u = 0; u < kBlock; ++u)
        for (int v = 0; v < kBlock; ++v)
          to[u * kStrides[a] + v * kStrides[b]] =
              from ? from[u * (kBlock * kBlock >> 3 * a) + v * (kBlock * kBlock >> 3 * b)] : none;
    }
  }
  // Values of the row (x, y), the last axis fastest; x and y from −1 to kBlock.
  const float* at(int x, int y) const { return &values_[(x + 1) * kStrides[0] + (y + 1) * kStrides[1] + 1]; }

 private:
  float* at(int x, int y) { return &values_[(x + 1) * kStrides[0] + (y + 1) * kStrides[1] + 1]; }
  std::array<float, kSide * kSide * kSide> values_;
};

// Updates all voxels `rounds` times from the values of the previous round: those of a voxel and its six neighbours −x,
// +x, −y, +y, −z, +z, `none` outside the blocks. `rule` is called with the block, the voxel and these values. Skips
// blocks for which none of them has changed in the previous round.
template <class Rule>
void update(Blocks& blocks, const Neighbours& neighbours, int rounds, float none, const Rule& rule) {
  Blocks next = blocks;
  std::vector<uint8_t> changed(blocks.size(), 1), changes(blocks.size());
  for (int round = 0; round < rounds; ++round) {
    inParallel(blocks.size(), [&](size_t b) {
      const auto& beside = neighbours.of(b);
      changes[b] = changed[b] || std::any_of(beside.begin(), beside.end(), [&](int o) { return o >= 0 && changed[o]; });
      if (!changes[b]) return;
      const Padded here(blocks, neighbours, b, none);
      for (int x = 0; x < kBlock; ++x)
        for (int y = 0; y < kBlock; ++y) {
          const int first = (x * kBlock + y) * kBlock;
          const float *row = here.at(x, y), *before_x = here.at(x - 1, y), *after_x = here.at(x + 1, y),
                      *before_y = here.at(x, y - 1), *after_y = here.at(x, y + 1);
          std::array<float, kBlock> made;
          for (int z = 0; z < kBlock; ++z)
            made[z] =
                rule(b, first + z, row[z],
                     std::array<float, 6>{before_x[z], after_x[z], before_y[z], after_y[z], row[z - 1], row[z + 1]});
          std::copy(made.begin(), made.end(), &next[b][first]);
        }
      changes[b] = std::memcmp(&next[b], &blocks[b], sizeof(BlockValues)) != 0;
    });
    std::swap(blocks, next), std::swap(changed, changes);
  }
}

// Maximum of six, without branches.
float greatest(const std::array<float, 6>& v) {
  return std::max(std::max(std::max(v[0], v[1]), std::max(v[2], v[3])), std::max(v[4], v[5]));
}

Blocks valuesOf(const SparseDistance& distance) {
  Blocks out;
  for (const SparseDistance::Block& block : distance.blocks) out.push_back(block.values);
  return out;
}

// Mask of thick parts: 1 near a voxel at least as deep as the band, else 0.
Blocks thickOf(const Blocks& hull, const Neighbours& neighbours, float band_m, int reach) {
  Blocks thick = hull;
  for (BlockValues& block : thick)
    for (float& value : block) value = value >= 0.99f * band_m;
  update(thick, neighbours, reach, 0,
         [](size_t, int, float here, const std::array<float, 6>& near) { return std::max(here, greatest(near)); });
  return thick;
}

// Proximity of depth data: 1 up to half of `reach` steps away, 0 beyond it.
Blocks evidenceOf(std::span<const BlockValues> trust, const Neighbours& neighbours, int reach) {
  Blocks near(trust.begin(), trust.end());
  for (BlockValues& block : near)
    for (float& value : block) value = value > 0 ? 2.0f : 0.0f;
  const float step = 2.0f / float(reach);
  update(near, neighbours, reach, 0, [step](size_t, int, float here, const std::array<float, 6>& beside) {
    return std::max(here, greatest(beside) - step);
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
  Blocks values = measured;
  update(values, neighbours, options.rounds, -band, [&](size_t b, int i, float, const std::array<float, 6>& near) {
    const float limit = limits[b][i], known = trust[b][i], least = measured[b][i];
    const float sum = near[0] + near[1] + near[2] + near[3] + near[4] + near[5];
    const float value = (known * least + stiffness * sum) / (known + 6 * stiffness);
    const bool stays = (limit <= -band) | ((known <= 0) & (thick[b][i] == 0));
    const float raised = known > 0 ? std::max(value, least) : value;
    return stays ? limit : std::min(raised, limit);
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

int DistanceSampler::blockOf(const glm::ivec3& voxel) const {
  const glm::ivec3 at(voxel.x & ~kMask, voxel.y & ~kMask, voxel.z & ~kMask);
  if (at != last_at_) last_at_ = at, last_block_ = index_.find(at);
  return last_block_;
}

float DistanceSampler::at(const glm::dvec3& point_in_world) const {
  const glm::dvec3 in_grid = (point_in_world - distance_.origin_in_world) * per_voxel_;
  const glm::ivec3 low(glm::floor(in_grid));
  const glm::vec3 f(in_grid - glm::dvec3(low));
  float v[8];
  // Bits of the axes along which the eight voxels lie in two blocks.
  const int split = ((low.x & kMask) == kMask) * 4 + ((low.y & kMask) == kMask) * 2 + ((low.z & kMask) == kMask);
  if (split == 0) {
    const int block = blockOf(low);
    if (block < 0) return -distance_.band_m;
    const float* from = &distance_.blocks[block].values[valueIndex(low)];
    for (int k = 0; k < 8; ++k) v[k] = from[(k >> 2) * 64 + (k >> 1 & 1) * 8 + (k & 1)];
  } else {
    int blocks[8];
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 at = low + glm::ivec3(k >> 2, k >> 1 & 1, k & 1);
      if ((k & split) == k) blocks[k] = blockOf(at);
      const int block = blocks[k & split];
      v[k] = block < 0 ? -distance_.band_m : distance_.blocks[block].values[valueIndex(at)];
    }
  }
  for (int k = 0; k < 4; ++k) v[k] += f.x * (v[k + 4] - v[k]);
  for (int k = 0; k < 2; ++k) v[k] += f.y * (v[k + 2] - v[k]);
  return v[0] + f.z * (v[1] - v[0]);
}

}  // namespace fourdvt::reconstruct
