// SPDX-License-Identifier: Apache-2.0
// Montage4D over layers: layered figures whose cameras are blended by fields on the surface in place of one angle per
// fragment. A camera sees a vertex if all faces there have it in their label sets (Appearance's masks); it fades out
// towards the end of that region (M4D Eq. 4) and follows the view with time (M4D Eq. 5). Streams and bakes are those of
// the plain blend, which takes over where all fields are small. In a blend of members only the heaviest has fields, at
// a share equal to its weight's excess over the sum of the others, which keeps the picture continuous where two are
// even. With Align::Flow all members have fields at once. Fields are kept per member of an Appearance, whose address,
// unlike a Look's, is stable between pictures; unused fields are dropped after a while. Cameras without one of the
// eight slots are weighted without seams.
#pragma once

#include <memory>

#include "render/passes.h"

namespace fourdvt::render {

// Clamp distance of SurfaceFields on a person. Triangles below 1 cm count as 1 cm: 8 % of the sample capture's 8,000.
constexpr float kLayeredClamp_m = 0.1f;
constexpr int kLayeredSteps = 12;

// Makes the pass for Recipe::setLayered. Errors: Unsupported: no half-float targets; the plain blend is the fallback.
Result<std::shared_ptr<LayeredPass>> makeLayeredMontage(gpu::Device& device);

}  // namespace fourdvt::render
