// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/distance_sampler.h"

namespace fourdvt::reconstruct {
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
