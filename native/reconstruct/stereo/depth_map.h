// SPDX-License-Identifier: Apache-2.0
// What one camera, with its neighbours' help, says about the surface: costs of depths, and a depth, per pixel. Does NOT
// compute them.
#pragma once

#include <cstdint>
#include <vector>

#include "base/camera.h"

namespace fourdvt::reconstruct {

constexpr int kMaxLabels = 128;  // planes per pixel

struct StereoReference {
  PinholeCamera camera;         // of the size of the reduced pictures
  std::vector<size_t> sources;  // whose patches are compared: the first with each of the others
};

// Costs of a band of depths at each pixel of a part of a reference's picture. Depths are planes, the same for all
// pixels: number k lies at k times `step_m` along the optical axis.
struct CostVolume {
  static constexpr uint8_t kOutside = 255;  // not inside the hull
  int x = 0, y = 0, width = 0, height = 0;  // pixels of the reference
  int labels = 0;                           // a multiple of 4
  float step_m = 0;
  std::vector<int> first_plane;  // height × width; the label l means plane first_plane + l; kNone: no hull
  std::vector<uint8_t> costs;    // height × width × labels
  static constexpr int kNone = -1;
};

struct DepthMap {
  PinholeCamera camera;
  int x = 0, y = 0, width = 0, height = 0;  // the part of the camera's picture that is kept
  std::vector<float> depth_m;               // height × width along the optical axis; 0: unknown
  std::vector<float> weight;                // 0 … 1: how much it is trusted
  std::vector<float> front_m;               // of the hull; 0: none
};

}  // namespace fourdvt::reconstruct
