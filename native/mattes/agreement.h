// SPDX-License-Identifier: Apache-2.0
// Silhouettes that no common volume explains: names the camera whose silhouette, calibration or time does not fit the
// others', and by how much.
#pragma once

#include <optional>
#include <string>

#include "mattes/support.h"

namespace fourdvt::mattes {

// Nothing if a common volume explains the silhouettes, or if they cannot be judged (fewer than three cameras that see
// something); else one line without a full stop: which camera, by how much. `masks`: as filmed.
std::optional<std::string> disagreement(const std::vector<capture::CaptureCamera>& cameras,
                                        const std::vector<cv::Mat>& masks);

}  // namespace fourdvt::mattes
