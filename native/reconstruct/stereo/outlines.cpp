// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "reconstruct/stereo/depth_fusion.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kTile = 16;  // pixels
constexpr double kStep_voxels = 0.5;
constexpr float kSafeStep = 0.7f;   // step, as a share of the distance, that cannot pass a surface
constexpr float kHullShare = 0.1f;  // preference for depth in the hull among points with equal removal
constexpr float kMore = 1.3f;       // overshoot of the added distance, since voxels beside the point get less
constexpr float kLess = 0.02f;      // voxels: tolerance for gaps

// Required increase of the distance at a point of a ray.
struct Gap {
  glm::dvec3 at{0};
  float missing_m = 0;
};

struct Ray {
  uint32_t view = 0;
  uint16_t x = 0, y = 0;
  float inside_px = 0;  // pixels inside its camera's outline
};

// Depth range in which each tile of a picture may meet the hull.
struct TileDepths {
  int across = 0, down = 0;
  std::vector<float> near_m, far_m;
  TileDepths(const PinholeCamera& camera, const SparseDistance& hull, std::span<const glm::ivec3> blocks);
};

// Blocks of the hull with a value inside.
std::vector<glm::ivec3> blocksInside(const SparseDistance& hull) {
  std::vector<glm::ivec3> out;
  for (const SparseDistance::Block& block : hull.blocks)
    if (*std::max_element(block.values.begin(), block.values.end()) > 0) out.push_back(block.at);
  return out;
}

TileDepths::TileDepths(const PinholeCamera& camera, const SparseDistance& hull, std::span<const glm::ivec3> blocks)
    : across((camera.width + kTile - 1) / kTile),
      down((camera.height + kTile - 1) / kTile),
      near_m(size_t(across) * down, std::numeric_limits<float>::infinity()),
      far_m(near_m.size(), 0) {
  for (const glm::ivec3& block : blocks) {
    glm::dvec2 low(1e9), high(-1e9);
    double nearest = 1e9, farthest = 0;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 corner = block + glm::ivec3(k & 1, k >> 1 & 1, k >> 2) * (kBlock + 1) - 1;
      const glm::dvec3 p = camera.project(hull.origin_in_world + glm::dvec3(corner) * hull.voxel_m);
      nearest = std::min(nearest, p.z), farthest = std::max(farthest, p.z);
      if (p.z <= 0) continue;
      low = glm::min(low, glm::dvec2(p)), high = glm::max(high, glm::dvec2(p));
    }
    if (farthest <= 0) continue;
    if (nearest <= 0) low = glm::dvec2(0), high = glm::dvec2(camera.width, camera.height);
    const auto tile = [](double pixel, int count) { return std::clamp(int(std::floor(pixel / kTile)), 0, count - 1); };
    if (high.x < 0 || high.y < 0 || low.x > camera.width || low.y > camera.height) continue;
    for (int y = tile(low.y, down); y <= tile(high.y, down); ++y)
      for (int x = tile(low.x, across); x <= tile(high.x, across); ++x) {
        const size_t i = size_t(y) * across + x;
        near_m[i] = std::min(near_m[i], float(std::max(nearest, hull.voxel_m)));
        far_m[i] = std::max(far_m[i], float(farthest));
      }
  }
}

class Outlines {
 public:
  Outlines(const SparseDistance& hull, std::span<const CarvingView> views, const OutlineOptions& options,
           SparseDistance& distance)
      : hull_(hull), views_(views), options_(options), distance_(distance), index_(hull.blocks) {
    const std::vector<glm::ivec3> inside = blocksInside(hull);
    for (const CarvingView& view : views) {
      const PinholeCamera& camera = view.silhouette->camera;
      tiles_.emplace_back(camera, hull, inside);
      eyes_.push_back(camera.centreInWorld());
      world_from_cam_.push_back(glm::transpose(glm::dmat3(camera.cam_from_world)));
    }
  }

  OutlineFigures run() {
    OutlineFigures out;
    std::vector<Ray> rays = all();
    out.rays = rays.size();
    for (int round = 0; round < options_.rounds && !rays.empty(); ++round) {
      std::vector<Gap> gaps = gapsOf(rays);
      if (round == 0) out.missing = rays.size();
      if (rays.empty()) break;
      fill(gaps);
    }
    if (!rays.empty()) gapsOf(rays);
    out.left = rays.size();
    return out;
  }

 private:
  glm::dvec3 direction(const Ray& ray) const {
    const PinholeCamera& c = views_[ray.view].silhouette->camera;
    return world_from_cam_[ray.view] * glm::dvec3((ray.x + 0.5 - c.cx) / c.fx, (ray.y + 0.5 - c.cy) / c.fy, 1);
  }

  // All pixels near the outlines, and a subset of the others.
  std::vector<Ray> all() const {
    std::vector<Ray> out;
    for (size_t v = 0; v < views_.size(); ++v) {
      const silhouette::Silhouette& silhouette = *views_[v].silhouette;
      for (int y = 0; y < silhouette.camera.height; ++y)
        for (int x = 0; x < silhouette.camera.width; ++x) {
          if (*silhouette.coverage.at(x, y) <= 127) continue;
          if (tiles_[v].far_m[size_t(y / kTile) * tiles_[v].across + x / kTile] <= 0) continue;
          const float inside = views_[v].distance.at(x + 0.5, y + 0.5);
          if (inside <= 0) continue;
          if (inside > options_.rim_px && (x % options_.stride_px || y % options_.stride_px)) continue;
          out.push_back({uint32_t(v), uint16_t(x), uint16_t(y), inside});
        }
    }
    return out;
  }

  // Required depth in the surface for a ray with depth `hull_m` in the hull.
  float needed(const Ray& ray, double depth_m, float hull_m) const {
    const PinholeCamera& c = views_[ray.view].silhouette->camera;
    const float pixel_m = float(depth_m * 2 / (c.fx + c.fy));
    return std::min(hull_m - float(options_.tolerance_px) * pixel_m, float(options_.depth_voxels * hull_.voxel_m));
  }

  // Steps along the ray through [near, far]; `at`, called with depth and point, returns the step; 0 stops.
  template <class At>
  void march(const Ray& ray, const At& at) const {
    const TileDepths& tiles = tiles_[ray.view];
    const size_t tile = size_t(ray.y / kTile) * tiles.across + ray.x / kTile;
    const glm::dvec3 along = direction(ray), eye = eyes_[ray.view];
    const double per_metre = 1 / glm::length(along);
    for (double z = tiles.near_m[tile]; z < tiles.far_m[tile];) {
      const double step = at(z, eye + z * along);
      if (step <= 0) return;
      z += std::max(step, kStep_voxels * hull_.voxel_m) * per_metre;
    }
  }

  bool hits(const Ray& ray) const {
    const DistanceSampler surface(distance_, index_);
    const PinholeCamera& c = views_[ray.view].silhouette->camera;
    const float per_depth = ray.inside_px * float(2 / (c.fx + c.fy));
    bool hit = false;
    march(ray, [&](double depth, const glm::dvec3& place) {
      const float value = surface.at(place);
      hit = value >= needed(ray, depth, per_depth * float(depth));
      return hit ? 0.0 : double(kSafeStep * std::max(-value, hull_.band_m * 1e-3f));
    });
    return hit;
  }

  // Gap of the ray at the point with the minimum missing depth; 0: none.
  Gap gapOf(const Ray& ray) const {
    struct Place {
      double depth;
      float hull, surface;
    };
    thread_local std::vector<Place> places;
    places.clear();
    const DistanceSampler surface(distance_, index_), hull(hull_, index_);
    float deepest = 0;
    double depth_there = 0;
    march(ray, [&](double depth, const glm::dvec3& place) {
      const float value = hull.at(place);
      if (value <= 0) return double(kSafeStep * std::max(-value, hull_.band_m * 1e-3f));
      places.push_back({depth, value, surface.at(place)});
      if (value > deepest) deepest = value, depth_there = depth;
      return kStep_voxels * hull_.voxel_m;
    });
    Gap out;
    const float need = needed(ray, depth_there, deepest);
    if (deepest <= 0 || need <= 0) return out;
    const Place* best = nullptr;
    const auto score = [](const Place& p) { return p.surface + kHullShare * p.hull; };
    for (const Place& place : places) {
      if (place.surface >= need) return out;
      if (place.hull >= 0.95f * need && (!best || score(place) > score(*best))) best = &place;
    }
    out.missing_m = need - best->surface;
    if (out.missing_m < kLess * float(hull_.voxel_m)) return {};
    out.at = eyes_[ray.view] + best->depth * direction(ray);
    return out;
  }

  // Computes all gaps, and keeps only the rays that have one.
  std::vector<Gap> gapsOf(std::vector<Ray>& rays) const {
    std::vector<Gap> gaps(rays.size());
    inParallel(rays.size(), [&](int i) {
      if (!hits(rays[i])) gaps[i] = gapOf(rays[i]);
    });
    size_t kept = 0;
    for (size_t i = 0; i < rays.size(); ++i)
      if (gaps[i].missing_m > 0) rays[kept] = rays[i], gaps[kept++] = gaps[i];
    rays.resize(kept), gaps.resize(kept);
    return gaps;
  }

  double reachOf(const Gap& gap) const { return options_.reach_voxels * hull_.voxel_m + gap.missing_m; }

  // Raises the distance around every gap, with fall-off, up to the hull.
  void fill(const std::vector<Gap>& gaps) {
    std::vector<std::vector<uint32_t>> by_block(hull_.blocks.size());
    for (size_t g = 0; g < gaps.size(); ++g) {
      const glm::dvec3 middle = (gaps[g].at - hull_.origin_in_world) / hull_.voxel_m;
      const double reach = reachOf(gaps[g]) / hull_.voxel_m;
      const glm::ivec3 low = glm::ivec3(glm::floor((middle - reach) / double(kBlock))),
                       high = glm::ivec3(glm::floor((middle + reach) / double(kBlock)));
      for (int x = low.x; x <= high.x; ++x)
        for (int y = low.y; y <= high.y; ++y)
          for (int z = low.z; z <= high.z; ++z) {
            const int block = index_.find(kBlock * glm::ivec3(x, y, z));
            if (block >= 0) by_block[block].push_back(uint32_t(g));
          }
    }
    inParallel(by_block.size(), [&](int b) {
      if (!by_block[b].empty()) raise(gaps, by_block[b], size_t(b));
    });
  }

  void raise(const std::vector<Gap>& gaps, const std::vector<uint32_t>& near, size_t b) {
    SparseDistance::Block& block = distance_.blocks[b];
    BlockValues rise{};
    for (const uint32_t g : near) {
      const glm::vec3 middle((gaps[g].at - hull_.origin_in_world) / hull_.voxel_m - glm::dvec3(block.at));
      const float reach = float(reachOf(gaps[g]) / hull_.voxel_m), missing = kMore * gaps[g].missing_m;
      const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(middle - reach)), glm::ivec3(0)),
                       high = glm::min(glm::ivec3(glm::floor(middle + reach)), glm::ivec3(kBlock - 1));
      for (int x = low.x; x <= high.x; ++x)
        for (int y = low.y; y <= high.y; ++y)
          for (int z = low.z; z <= high.z; ++z) {
            const glm::vec3 way = (glm::vec3(x, y, z) - middle) / reach;
            const float share = 1 - glm::dot(way, way);
            if (share <= 0) continue;
            float& value = rise[size_t(x) << 6 | size_t(y) << 3 | size_t(z)];
            value = std::max(value, missing * share * share);
          }
    }
    for (size_t i = 0; i < rise.size(); ++i)
      if (rise[i] > 0)
        block.values[i] = std::max(block.values[i], std::min(block.values[i] + rise[i], hull_.blocks[b].values[i]));
  }

  const SparseDistance& hull_;
  std::span<const CarvingView> views_;
  const OutlineOptions& options_;
  SparseDistance& distance_;
  BlockIndex index_;
  std::vector<TileDepths> tiles_;
  std::vector<glm::dvec3> eyes_;
  std::vector<glm::dmat3> world_from_cam_;
};

}  // namespace

OutlineFigures keepOutlines(const SparseDistance& hull, std::span<const CarvingView> views,
                            const OutlineOptions& options, SparseDistance& distance) {
  return Outlines(hull, views, options, distance).run();
}

}  // namespace fourdvt::reconstruct
