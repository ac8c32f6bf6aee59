// SPDX-License-Identifier: Apache-2.0
// The study's views: a ring through the cameras' directions and between them. Does NOT draw.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"

namespace fourdvt::study {

// `count` azimuths, ascending in 0..360. Every 360/count degrees from the first camera, each camera's direction and
// each middle between two neighbours taking the place of the nearest one; with fewer views than that, a selection of
// camera and middle directions in turn.
std::vector<double> ringAzimuths_deg(std::vector<double> camera_azimuths_deg, int count);

struct RingView {
  PinholeCamera camera;  // name: "az022.5"
  uint32_t frame = 0;    // view i shows frame i·n/count
};
// Looking at the centre of the bounds. Elevation and distance follow those of the cameras over azimuth; the focal
// length is the cameras' mean, so that pixels are as dense as theirs; the picture is as large as the performer needs,
// and no larger than the cameras' pictures.
std::vector<RingView> ringViews(std::span<const PinholeCamera> cameras, const BoundingBox& bounds, uint32_t frame_count,
                                int count);

}  // namespace fourdvt::study
