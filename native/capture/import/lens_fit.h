// SPDX-License-Identifier: Apache-2.0
// Lens models with a fourth radial coefficient, which OpenCV's model lacks.
#pragma once

#include "capture/capture.h"

namespace fourdvt::capture {

// Brown's model 1 + k1 r² + k2 r⁴ + k3 r⁶ + k4 r⁸ with OpenCV's tangential p1 and p2.
struct Brown4 {
  double k1 = 0, k2 = 0, k3 = 0, k4 = 0, p1 = 0, p2 = 0;
};

struct LensFit {
  Distortion distortion;
  double residual = 0;  // maximum distance to the given lens within the radius, in focal lengths
};

// Fits OpenCV's rational model to the lens up to `radius` (normalised coordinates); exact where k4 is 0.
LensFit fitBrown4(const Brown4& lens, double radius);

}  // namespace fourdvt::capture
