// SPDX-License-Identifier: Apache-2.0
// The methods by which the recipe draws figures from cameras. Each is a fragment shader that gives a camera's weight at
// a point (camera_shade.glsl); choice of cameras, depth maps, pictures and the colours of unseen surface are common.
#pragma once

#include <memory>
#include <string_view>

#include "render/method.h"

namespace fourdvt::render {

// name: "fvvr" (LVDT Eq. 3-4 at run time); to look at the surface itself: "wireframe", "silhouette". Errors:
// InvalidArgument: there is no such method.
Result<std::unique_ptr<Method>> makeCameraMethod(std::string_view name);

}  // namespace fourdvt::render
