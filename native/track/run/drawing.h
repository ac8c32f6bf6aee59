// SPDX-License-Identifier: Apache-2.0
// Pictures of the tracked mesh for the report. RGB.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "track/views.h"

namespace fourdvt::track {

// Sheet with a column per camera that sees the performer, at most eight: the picture above the shaded mesh with the
// outline of the matte in green. `heat`: [vertex] 0 … 1 from grey to red, negative: blue; empty: grey.
Image trackedSheet(const std::string& title, const std::vector<View>& views, const std::vector<glm::uvec3>& faces,
                   const Positions& positions, std::span<const float> heat);

}  // namespace fourdvt::track
