// SPDX-License-Identifier: Apache-2.0
#include "gpu/gles_platform.h"

#include <GLES3/gl3.h>

#include <cstring>

namespace fourdvt::gpu {

Result<Caps> readCaps() {
  const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
  if (!version) return Error{ErrorId::GpuFailure, "no current GL context; create an EGL context first"};
  GLint major = 0, count = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  if (major < 3)
    return Error{ErrorId::GpuFailure, std::string("OpenGL ES 3.0 is needed, but the context is ") + version};
  Caps caps;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &caps.max_texture_size);
  glGetIntegerv(GL_MAX_SAMPLES, &caps.max_samples);
  if (const GLubyte* name = glGetString(GL_RENDERER)) caps.renderer = reinterpret_cast<const char*>(name);
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
    if (!name) continue;
    if (std::strcmp(name, "GL_EXT_color_buffer_float") == 0) caps.float_targets = caps.half_float_targets = true;
    if (std::strcmp(name, "GL_EXT_color_buffer_half_float") == 0) caps.half_float_targets = true;
  }
  return caps;
}

void readPackBuffer(int offset_bytes, int bytes, void* out) {
  const void* mapped = glMapBufferRange(GL_PIXEL_PACK_BUFFER, offset_bytes, bytes, GL_MAP_READ_BIT);
  if (!mapped) return;
  std::memcpy(out, mapped, static_cast<size_t>(bytes));
  glUnmapBuffer(GL_PIXEL_PACK_BUFFER);
}

}  // namespace fourdvt::gpu
