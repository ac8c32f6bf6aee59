// SPDX-License-Identifier: Apache-2.0
#include "gpu/shader_reader.h"

#include <utility>

namespace fourdvt::gpu {
namespace {

ShaderReader shader_reader;

}  // namespace

void readShadersBy(ShaderReader reader) { shader_reader = std::move(reader); }

std::string_view readShader(std::string_view name, std::string_view embedded) {
  return shader_reader ? shader_reader(name) : embedded;
}

}  // namespace fourdvt::gpu
