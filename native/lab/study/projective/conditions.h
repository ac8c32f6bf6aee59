// SPDX-License-Identifier: Apache-2.0
// Variables of the study: methods by name, and conditions, which are all other settings.
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
  studio::StudioKnobs errors;  // calibration and gain, with a fixed seed; proxy_mm: surface
  bool all_methods = true;     // false: those of axisMethods

  std::string setting() const;  // "axis=… at=… proxy=… closest=…"
  std::string name() const;     // for files: "rotation-0.1"
};

// Surfaces against each other, all methods.
std::vector<Condition> proxyConditions(bool quick);
// Variations of one axis at a time from the base, axisMethods only.
std::vector<Condition> cameraConditions(bool quick);
std::vector<Condition> calibrationConditions(bool quick);

// All methods of the study in the report's order.
const std::vector<std::string>& allMethods();
// Methods measured on the axes, which bounds the time.
const std::vector<std::string>& axisMethods();

// Cameras under this calibration: the virtual studio's errors (lab/studio/rig.h).
std::vector<PinholeCamera> miscalibrated(const std::vector<PinholeCamera>& cameras, const Condition& condition);
// Pictures with the condition's gains per camera and channel, as in the virtual studio.
std::vector<Image> withGains(std::vector<Image> pictures, const Condition& condition);

}  // namespace fourdvt::study
