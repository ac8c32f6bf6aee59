// SPDX-License-Identifier: Apache-2.0
// A bake's lengths that suit a person; the surface's length scale (base/length_scale.h) multiplies them.
#pragma once

namespace fourdvt::bake {

inline constexpr double kLayersStep_m = 0.00025, kCamerasStep_m = 0.001;  // position steps
inline constexpr double kCoarseStep_m = 0.002, kBlendError_m = 0.001, kAlignmentStep_m = 0.0001;

}  // namespace fourdvt::bake
