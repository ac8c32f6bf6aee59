// SPDX-License-Identifier: Apache-2.0
// Floating Textures of a still scene (FT 4.1): flow between the pictures of every two cameras in use, in each camera's
// own view, is computed when geometry or picture change and kept; a view is a look-up, in which every camera's view
// tells how far each picture is displaced. It pays where many views of one frame are drawn, as while playback is
// paused; each new frame costs n (n - 1) flows. Another choice of cameras computes what is missing.
#pragma once

#include <memory>

#include "render/method.h"

namespace fourdvt::render {

// Errors: Unsupported: the device has no half-float targets.
Result<std::unique_ptr<Method>> makeFloatingStatic(gpu::Device& device);

}  // namespace fourdvt::render
