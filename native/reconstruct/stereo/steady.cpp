// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/steady.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <unordered_map>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr float kNoise = 2.5f, kClear = 6.0f;           // mean difference in a window, levels of 255
constexpr float kHullStill = 0.05f, kHullMoves = 0.2f;  // change of the hull's distance, voxels
constexpr int kWindow = 7;                              // reduced pixels
constexpr float kSeen_m = 0.03f;                        // maximum depth of a visible point behind the surface

struct Changed {
  std::vector<float> change;
  const DepthMap* map;
  glm::mat4 pixel_from_world;  // to pixels of the map's part of the picture
  int picture_width;
};

// Maximum change over the cameras that see a point; 1 if none does.
float changeAt(const std::vector<Changed>& cameras, const glm::vec3& point) {
  float most = 0;
  bool seen = false;
  for (const Changed& c : cameras) {
    if (most >= 1) break;
    const glm::vec3 p(c.pixel_from_world * glm::vec4(point, 1));
    if (p.z <= 0) continue;
    const float x = p.x / p.z, y = p.y / p.z;
    if (!(x >= 0 && y >= 0 && x < c.map->width && y < c.map->height)) continue;
    const size_t i = size_t(y) * c.map->width + size_t(x);
    const float surface = c.map->depth_m[i] > 0 ? c.map->depth_m[i] : c.map->front_m[i];
    if (surface > 0 && p.z > surface + kSeen_m) continue;
    seen = true;
    most = std::max(most, c.change[size_t(c.map->y + int(y)) * c.picture_width + c.map->x + int(x)]);
  }
  return seen ? most : 1;
}

}  // namespace

std::vector<float> changeOf(const Image& before, const Image& now) {
  const cv::Mat a(before.height, before.width, CV_8UC4, const_cast<uint8_t*>(before.pixels.data()));
  const cv::Mat b(now.height, now.width, CV_8UC4, const_cast<uint8_t*>(now.pixels.data()));
  cv::Mat difference, mean;
  cv::absdiff(a, b, difference);
  cv::boxFilter(difference, mean, CV_32F, {kWindow, kWindow});
  std::vector<float> out(size_t(now.width) * now.height);
  for (size_t i = 0; i < out.size(); ++i) {
    const auto& m = mean.at<cv::Vec4f>(int(i / now.width), int(i % now.width));
    const float most = std::max(std::max(m[0], m[1]), std::max(m[2], m[3]));
    out[i] = std::clamp((most - kNoise) / (kClear - kNoise), 0.0f, 1.0f);
  }
  return out;
}

void SteadyDistance::forget() {
  pictures_.clear();
  before_ = {}, hull_ = {};
}

namespace {

using KnownBlocks = std::unordered_map<uint64_t, const SparseDistance::Block*>;

KnownBlocks knownBlocks(const SparseDistance& distance) {
  KnownBlocks out;
  for (const SparseDistance::Block& block : distance.blocks) out[blockKey(block.at)] = &block;
  for (const glm::ivec3& at : distance.inside) out[blockKey(at)] = nullptr;
  return out;
}

// Previous values of a block; outside where there was none.
class BlockBefore {
 public:
  BlockBefore(const KnownBlocks& known, const glm::ivec3& at, float band_m) : band_m_(band_m) {
    const auto found = known.find(blockKey(at));
    outside_ = found == known.end();
    block_ = outside_ ? nullptr : found->second;
  }
  float at(size_t i) const { return block_ ? block_->values[i] : outside_ ? -band_m_ : band_m_; }

 private:
  float band_m_;
  bool outside_;
  const SparseDistance::Block* block_;
};

}  // namespace

void SteadyDistance::blend(std::span<const Image> pictures, std::span<const DepthMap> maps, const SparseDistance& hull,
                           SparseDistance& distance) {
  if (pictures_.size() == pictures.size() && before_.voxel_m == distance.voxel_m) {
    std::vector<Changed> cameras;
    for (size_t c = 0; c < maps.size(); ++c) {
      const DepthMap& map = maps[c];
      if (map.width == 0) continue;
      glm::dmat4 k(1.0);
      k[0][0] = map.camera.fx, k[1][1] = map.camera.fy;
      k[2][0] = map.camera.cx - map.x, k[2][1] = map.camera.cy - map.y;
      cameras.push_back(
          {changeOf(pictures_[c], pictures[c]), &map, glm::mat4(k * map.camera.cam_from_world), pictures[c].width});
    }
    const KnownBlocks known = knownBlocks(before_), known_hull = knownBlocks(hull_);
    const float voxel = float(distance.voxel_m);
    inParallel(distance.blocks.size(), [&](int b) {
      SparseDistance::Block& block = distance.blocks[b];
      const BlockBefore before(known, block.at, distance.band_m), hull_before(known_hull, block.at, distance.band_m);
      for (size_t i = 0; i < block.values.size(); ++i) {
        const float change = before.at(i) - block.values[i];
        if (change == 0) continue;
        const float hull_change = std::abs(hull_before.at(i) - hull.blocks[b].values[i]) / voxel;
        const float still = block.values[i] < hull.blocks[b].values[i]
                                ? 1
                                : std::clamp((kHullMoves - hull_change) / (kHullMoves - kHullStill), 0.0f, 1.0f);
        if (still <= 0) continue;
        const glm::vec3 point(distance.origin_in_world + glm::dvec3(voxelOf(block, i)) * distance.voxel_m);
        block.values[i] += kept_ * still * (1 - changeAt(cameras, point)) * change;
      }
    });
  }
  pictures_.assign(pictures.begin(), pictures.end());
  before_ = distance;
  hull_ = hull;
}

}  // namespace fourdvt::reconstruct
