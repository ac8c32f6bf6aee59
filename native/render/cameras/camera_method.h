// SPDX-License-Identifier: Apache-2.0
// The methods by which the recipe draws figures from cameras, by their names. The simple ones are a fragment shader
// that gives a camera's weight at a point (camera_shade.glsl). What all share: choice of cameras, depth maps, colours
// of unseen surface (figure_cameras.h), pictures and the test of what a camera sees (camera_blend.h).
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "render/method.h"

namespace fourdvt::render {

enum class MethodGroup {
  Textured,    // shows the figure: what a visitor chooses from and the study compares
  Inspection,  // shows the surface itself, or what a method works with
};

// In the order in which people are told of them; the first is the default.
std::vector<std::string> cameraMethodNames(MethodGroup group);

// Errors: InvalidArgument: there is no such method; Unsupported: this device cannot run it.
Result<std::unique_ptr<Method>> makeCameraMethod(gpu::Device& device, std::string_view name);

struct MethodThatServes {
  std::unique_ptr<Method> method;
  std::string name;    // of the method
  std::string notice;  // what is drawn in place of what, and why; empty: the method that was asked for
};

// The method that the character's manifest names; the default where it names none, and where this player does not know
// its name.
std::string methodOf(const package::Character& character);

// As makeCameraMethod; where the device cannot run the method, one that every device can run in its place, "lumigraph".
Result<MethodThatServes> makeMethodThatServes(gpu::Device& device, std::string_view name);
// That of the character, likewise; the notice also says so where its name is not known.
Result<MethodThatServes> makeMethodOf(gpu::Device& device, const package::Character& character);

}  // namespace fourdvt::render
