// SPDX-License-Identifier: Apache-2.0
#include "gpu/gles_pack_buffer.h"

#include <GLES3/gl3.h>
#include <webgl/webgl2.h>

namespace fourdvt::gpu {

void readPackBuffer(int offset_bytes, int bytes, void* out) {
  glGetBufferSubData(GL_PIXEL_PACK_BUFFER, offset_bytes, bytes, out);
}

}  // namespace fourdvt::gpu
