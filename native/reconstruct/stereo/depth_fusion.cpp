// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/depth_fusion.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>

namespace fourdvt::reconstruct {
namespace {

constexpr float kOneSurface_m = 0.03f;  // depths of neighbouring pixels that differ by less belong together

// Signed distance of a place to the surface of a map, metres along the optical axis, positive behind it.
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
  // False where the map does not know.
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
    // Bilinear where the four depths belong to one surface.
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

// The weighted median of n > 0 values.
float median(Evidence* e, int n, float total) {
  std::sort(e, e + n, [](const Evidence& a, const Evidence& b) { return a.distance < b.distance; });
  float sum = 0;
  for (int k = 0; k < n; ++k) {
    sum += e[k].weight;
    if (sum >= 0.5f * total) return e[k].distance;
  }
  return e[n - 1].distance;
}

// What the hull says of a place, `hull_m`, and the maps: the mean of those that lie near their median. `trust`: their
// weight, 0 if it is too little.
float fused(const std::vector<MapAtPoint>& maps, const glm::vec3& point, float hull_m, const FusionOptions& options,
            std::vector<Evidence>& evidence, float& trust) {
  const float truncation = float(options.truncation_m), stays = float(options.hull_stays_m);
  int n = 0;
  float total = 0;
  for (const MapAtPoint& map : maps)
    if (map.at(point, truncation, evidence[n])) total += evidence[n++].weight;
  if (total <= options.least_weight) return hull_m;
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

}  // namespace fourdvt::reconstruct
