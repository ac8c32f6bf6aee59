// SPDX-License-Identifier: Apache-2.0
// Consistency of silhouettes: names the camera whose silhouette, calibration or time does not fit a common visual hull,
// and by how much.
#pragma once

#include <optional>
#include <string>

#include "mattes/support.h"

namespace fourdvt::mattes {

// Names the camera that does not fit and by how much, in one line without a full stop. nullopt if a common volume
// explains the silhouettes, or with fewer than three cameras that see something. `masks`: as filmed.
std::optional<std::string> disagreement(const std::vector<capture::CaptureCamera>& cameras,
                                        const std::vector<cv::Mat>& masks);

}  // namespace fourdvt::mattes
