// SPDX-License-Identifier: Apache-2.0
// Shaders from elsewhere than the program that they are embedded in, for those who write them. Native only.
#pragma once

#include <functional>
#include <string_view>

namespace fourdvt::gpu {

// Returns the text of an embedded shader's file, which lives as long as the program.
using ShaderReader = std::function<std::string_view(std::string_view name)>;
// shaderText and its likes return what `reader` does from now on, and what is embedded where it is empty. Not
// thread-safe: before programs are made.
void readShadersBy(ShaderReader reader);
// Used by what embed_shaders.cmake writes.
std::string_view readShader(std::string_view name, std::string_view embedded);

}  // namespace fourdvt::gpu
