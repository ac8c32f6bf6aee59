// SPDX-License-Identifier: Apache-2.0
// Montage4D over layers: layered figures whose blend of cameras follows fields on the surface in place of one angle per
// fragment. A camera's state at a vertex is whether all faces there have it in their label sets (Appearance's masks);
// it fades out towards where that ends (M4D Eq. 4) and follows the view with time (Eq. 5). Streams and bakes are the
// same as for the plain blend, which takes over where all fields are small.
// Of a blend of members the heaviest one has fields; they count as far as it outweighs the others together, so that
// nothing jumps where two are even. Fields belong to a member of an appearance, which stays where it is from picture to
// picture; looks need not, and with Align::Flow all members have fields at once. Fields that are long unused are
// forgotten. Cameras that find no slot of the eight are weighted as if they had no seam.
#pragma once

#include <memory>

#include "render/passes.h"

namespace fourdvt::render {

// Reach of SurfaceFields' distances on a person: triangles below 1 cm count as 1 cm, 8 % of the sample's 8,000.
constexpr float kLayeredClamp_m = 0.1f;
constexpr int kLayeredSteps = 12;

// For Recipe::setLayered. Errors: Unsupported: the device has no half-float targets, and the plain blend is what
// serves.
Result<std::shared_ptr<LayeredPass>> makeLayeredMontage(gpu::Device& device);

}  // namespace fourdvt::render
