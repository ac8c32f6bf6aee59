// SPDX-License-Identifier: Apache-2.0
// Views of the study: a ring through the cameras' directions and between them.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"

namespace fourdvt::study {

// Returns `count` azimuths, ascending in 0..360: every 360/count degrees from the first camera, with each camera's
// direction and each middle between two neighbours replacing the nearest one; for fewer views, a selection of
// alternating camera and middle directions.
std::vector<double> ringAzimuths_deg(std::vector<double> camera_azimuths_deg, int count);

struct RingView {
  PinholeCamera camera;  // name: "az022.5"
  uint32_t frame = 0;    // view i shows frame i·n/count
};
// Cameras that face the centre of the bounds. Elevation and distance follow those of the cameras over azimuth; the
// focal length is the cameras' mean, for equal pixel density; the picture has the minimum size that fits the performer,
// bounded by the cameras' pictures.
std::vector<RingView> ringViews(std::span<const PinholeCamera> cameras, const BoundingBox& bounds, uint32_t frame_count,
                                int count);

}  // namespace fourdvt::study
