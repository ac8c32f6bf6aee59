// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/consistency.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace fourdvt::reconstruct {

float depthAt(const DepthMap& map, double x, double y) {
  const double column = std::floor(x) - map.x, row = std::floor(y) - map.y;
  if (!(column >= 0 && row >= 0 && column < map.width && row < map.height)) return 0;
  return map.depth_m[size_t(row) * map.width + size_t(column)];
}

namespace {

constexpr float kSlopeReach = 2;                 // pixels over which a slope is taken
constexpr float kOtherSurface_m = 0.1f;          // depths that far apart are not of one surface
constexpr double kChance = 0.78, kSound = 0.92;  // shares of confirmed depths: by chance; of a sound calibration
constexpr float kEdgeCosine = 0.2f;              // beside such a step

// Squared cosine between the surface and the ray at a pixel, from the depths round it.
float facing(const DepthMap& map, int x, int y) {
  const int reach = int(kSlopeReach);
  if (x < reach || y < reach || x + reach >= map.width || y + reach >= map.height) return kEdgeCosine * kEdgeCosine;
  const float* at = &map.depth_m[size_t(y) * map.width + x];
  const float left = at[-reach], right = at[reach], up = at[-reach * map.width], down = at[reach * map.width];
  const float low = std::min(std::min(left, right), std::min(up, down)),
              high = std::max(std::max(left, right), std::max(up, down));
  if (low <= 0 || high - low > kOtherSurface_m) return kEdgeCosine * kEdgeCosine;
  const float pixel_m = 2 * kSlopeReach * *at / float(map.camera.fx);
  const float across = (right - left) / pixel_m, along = (down - up) / pixel_m;
  return 1 / (1 + across * across + along * along);
}

// How much a map is believed as a whole: depths of a camera that is calibrated badly are refuted about as often as
// confirmed, by chance.
float believedOf(double confirmed, double refuted) {
  if (confirmed <= 0) return 0;
  const double share = confirmed / (confirmed + refuted);
  return float(std::clamp((share - kChance) / (kSound - kChance), 0.0, 1.0));
}

}  // namespace

void weighByAngle(DepthMap& map) {
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const size_t i = size_t(y) * map.width + x;
      if (map.depth_m[i] > 0) map.weight[i] *= facing(map, x, y);
    }
}

void keepConsistent(std::span<DepthMap> maps, double tolerance_m) {
  std::vector<std::vector<float>> weights(maps.size());
  std::vector<glm::dmat4> world_from_cam;
  for (const DepthMap& map : maps) world_from_cam.push_back(glm::inverse(map.camera.cam_from_world));
  inParallel(maps.size(), [&](int m) {
    const DepthMap& map = maps[m];
    weights[m].assign(map.depth_m.size(), 0);
    double confirmed = 0, refuted = 0;
    for (size_t i = 0; i < map.depth_m.size(); ++i) {
      const double z = map.depth_m[i];
      if (z <= 0) continue;
      const double x = map.x + double(i % map.width) + 0.5, y = map.y + double(i / map.width) + 0.5;
      const glm::dvec3 point(world_from_cam[m] * glm::dvec4((x - map.camera.cx) / map.camera.fx * z,
                                                            (y - map.camera.cy) / map.camera.fy * z, z, 1));
      int agree = 0, against = 0;
      for (size_t o = 0; o < maps.size(); ++o) {
        if (int(o) == m) continue;
        const glm::dvec3 p = maps[o].camera.project(point);
        if (p.z <= 0) continue;
        const float there = depthAt(maps[o], p.x, p.y);
        if (there <= 0) continue;
        agree += std::abs(there - p.z) < tolerance_m;
        against += there > p.z + 2 * tolerance_m;
      }
      if (agree > 0 && agree >= against) {
        confirmed += map.weight[i];
        weights[m][i] = map.weight[i] * float(agree) / float(agree + against);
      } else if (against > 0) {
        refuted += map.weight[i];
      }
    }
    const float believed = believedOf(confirmed, refuted);
    for (float& weight : weights[m]) weight *= believed;
  });
  for (size_t m = 0; m < maps.size(); ++m)
    for (size_t i = 0; i < weights[m].size(); ++i) {
      maps[m].weight[i] = weights[m][i];
      if (weights[m][i] <= 0) maps[m].depth_m[i] = 0;
    }
}

}  // namespace fourdvt::reconstruct
