// SPDX-License-Identifier: Apache-2.0
// A method that is one draw of the surface with its own fragment shader.
#pragma once

#include <memory>

#include "render/method.h"

namespace fourdvt::render {

enum class ShaderCameras {
  None,     // the shader shows the surface alone
  Chosen,   // it blends the cameras that the options choose (camera_shade.glsl)
  Bounded,  // and gets one more, which bounds their weights (camera_lumigraph.glsl)
};

std::unique_ptr<Method> makeShaderMethod(const char* fragment_file, ShaderCameras cameras);

}  // namespace fourdvt::render
