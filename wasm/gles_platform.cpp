// SPDX-License-Identifier: Apache-2.0
#include "gpu/gles_platform.h"

#include <GLES3/gl3.h>
#include <emscripten.h>
#include <webgl/webgl2.h>

namespace fourdvt::gpu {
namespace {

// Bit 0: half-float targets; bit 1: float targets. Emscripten's own query would copy the context's strings into the
// heap.
EM_JS(int, fdvt_enable_float_targets, (), {
  return (GLctx.getExtension("EXT_color_buffer_half_float") ? 1 : 0) |
         (GLctx.getExtension("EXT_color_buffer_float") ? 3 : 0);
});

}  // namespace

Result<Caps> readCaps() {
  Caps caps;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &caps.max_texture_size);
  glGetIntegerv(GL_MAX_SAMPLES, &caps.max_samples);
  const int floats = fdvt_enable_float_targets();
  caps.half_float_targets = floats & 1;
  caps.float_targets = floats & 2;
  return caps;
}

void readPackBuffer(int offset_bytes, int bytes, void* out) {
  glGetBufferSubData(GL_PIXEL_PACK_BUFFER, offset_bytes, bytes, out);
}

}  // namespace fourdvt::gpu
