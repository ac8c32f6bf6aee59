// SPDX-License-Identifier: Apache-2.0
// What the study varies: methods by name, and conditions, which are everything but the method. Does NOT measure.
#pragma once

#include <string>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "gpu/device.h"
#include "lab/studio/studio.h"
#include "lab/study/run/projective_rows.h"
#include "render/method.h"

namespace fourdvt::study {

struct Condition {
  std::string axis = rows::kAxisProxy, at = rows::kProxyGiven;
  std::string proxy = rows::kProxyGiven;
  int closest = rows::kClosest;
  studio::StudioKnobs errors;  // of calibration and gain: their seed is fixed; proxy_mm: of the surface
  bool all_methods = true;     // else those of axisMethods

  std::string setting() const;  // "axis=… at=… proxy=… closest=…"
  std::string name() const;     // for files: "rotation-0.1"
};

// Surfaces against each other, all methods.
std::vector<Condition> proxyConditions(bool quick);
// One axis at a time away from the base, axisMethods only.
std::vector<Condition> cameraConditions(bool quick);
std::vector<Condition> calibrationConditions(bool quick);

// All methods of the study in the report's order.
const std::vector<std::string>& allMethods();
// What the axes are measured with, so that they take bounded time.
const std::vector<std::string>& axisMethods();

// The cameras as this calibration has them: the virtual studio's errors (lab/studio/rig.h).
std::vector<PinholeCamera> miscalibrated(const std::vector<PinholeCamera>& cameras, const Condition& condition);
// The pictures as cameras with such gains take them: per camera and channel, as the virtual studio's.
std::vector<Image> withGains(std::vector<Image> pictures, const Condition& condition);

}  // namespace fourdvt::study
