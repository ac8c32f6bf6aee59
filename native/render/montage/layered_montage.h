// SPDX-License-Identifier: Apache-2.0
// Montage4D over layers: layered figures with cameras blended by fields on the surface in place of one angle per
// fragment. A camera is visible at a vertex if all faces there have it in their label sets (Appearance's masks); it
// fades out towards the end of that region (M4D Eq. 4) and follows the view with time (M4D Eq. 5). Streams and bakes
// are those of the plain blend, which takes over where all fields are small. In a blend of members the heaviest one has
// fields; their share is its excess over the sum of the others, which keeps the picture continuous where two are even.
// Fields belong to a member of an appearance, whose address is stable between pictures, unlike that of a look; with
// Align::Flow all members have fields at once. Unused fields are dropped after a while. Cameras without one of the
// eight slots are weighted without seams.
#pragma once

#include <memory>

#include "render/passes.h"

namespace fourdvt::render {

// Reach of SurfaceFields' distances on a person: triangles below 1 cm count as 1 cm, 8 % of the sample's 8,000.
constexpr float kLayeredClamp_m = 0.1f;
constexpr int kLayeredSteps = 12;

// Makes the pass for Recipe::setLayered. Errors: Unsupported: no half-float targets; the plain blend is the fallback.
Result<std::shared_ptr<LayeredPass>> makeLayeredMontage(gpu::Device& device);

}  // namespace fourdvt::render
