// SPDX-License-Identifier: Apache-2.0
// Replaces the shaders that are embedded in a native program, for example by the files of a folder. Not in wasm.
#pragma once

#include <functional>
#include <string_view>

namespace fourdvt::gpu {

// Returns the text of an embedded shader's file, which lives as long as the program.
using ShaderReader = std::function<std::string_view(std::string_view name)>;
// Sets the reader that shaderText and the functions like it return the result of; an empty one: the embedded texts. Not
// thread-safe; call it before the first shader is compiled.
void readShadersBy(ShaderReader reader);
// Returns the reader's text of that name, or `embedded` without a reader. Called by the code that embed_shaders.cmake
// generates.
std::string_view readShader(std::string_view name, std::string_view embedded);

}  // namespace fourdvt::gpu
