// SPDX-License-Identifier: Apache-2.0
// Methods for figures from cameras, by name. A simple method is one fragment shader that computes a camera's blend
// weight at a point (camera_shade.glsl). All share camera selection, depth maps and colours of unseen surface
// (figure_cameras.h), and pictures and visibility test (camera_blend.h).
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "render/method.h"

namespace fourdvt::render {

enum class MethodGroup {
  Textured,    // shows the figure; offered to visitors and compared in the study
  Inspection,  // shows the surface itself, or intermediate results of a method
};

// Returns the names in display order; the first is the default.
std::vector<std::string> cameraMethodNames(MethodGroup group);

// Errors: InvalidArgument: unknown name; Unsupported: the device cannot run the method.
Result<std::unique_ptr<Method>> makeCameraMethod(gpu::Device& device, std::string_view name);

struct SupportedMethod {
  std::unique_ptr<Method> method;
  std::string name;    // name of the method
  std::string notice;  // fallback taken and its reason; empty: the requested method
};

// Returns the method named by the character's manifest; the default where the name is missing or unknown.
std::string methodOf(const package::Character& character);

// Makes the method like makeCameraMethod; falls back to "lumigraph", which runs on every device, where Unsupported.
Result<SupportedMethod> makeSupportedMethod(gpu::Device& device, std::string_view name);
// Makes the character's method with the same fallback; the notice also reports an unknown name.
Result<SupportedMethod> makeMethodOf(gpu::Device& device, const package::Character& character);

}  // namespace fourdvt::render
