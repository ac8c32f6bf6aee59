// SPDX-License-Identifier: Apache-2.0
// Montage4D (M4D 4.2 to 4.5) and the blend that it is compared with, for figures from cameras. Up to eight cameras, in
// slots of fields on the surface. What depends on surface and pictures only (who serves a vertex, votes, seams, their
// distances) is kept from view to view; what the view wants, and the fields that follow it, are made for every picture.
// Not in: the paper's ambient occlusion.
#pragma once

#include <memory>
#include <string_view>

#include "render/method.h"

namespace fourdvt::render {

// "montage4d"; "holoportation": normal weights, dilated depth discontinuities, votes; to look at: "montage4d-seams",
// "montage4d-weights". Null: another name. Errors: Unsupported: the device cannot draw into half-float textures, which
// all but "holoportation" need.
Result<std::unique_ptr<Method>> makeMontage(gpu::Device& device, std::string_view name);

}  // namespace fourdvt::render
