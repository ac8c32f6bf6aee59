// SPDX-License-Identifier: Apache-2.0
// The methods by which the recipe draws figures from cameras. The simple ones are a fragment shader that gives a
// camera's weight at a point (camera_shade.glsl). What all share: choice of cameras, depth maps, colours of unseen
// surface (figure_cameras.h), pictures and the test of what a camera sees (camera_blend.h).
#pragma once

#include <memory>
#include <string_view>

#include "render/method.h"

namespace fourdvt::render {

// name: "fvvr" (LVDT Eq. 3-4 at run time); to look at the surface itself: "wireframe", "silhouette". Errors:
// InvalidArgument: there is no such method; Unsupported: the device cannot run it, and "lumigraph" is what serves.
Result<std::unique_ptr<Method>> makeCameraMethod(gpu::Device& device, std::string_view name);

}  // namespace fourdvt::render
