// SPDX-License-Identifier: Apache-2.0
#include "gpu/gles_pack_buffer.h"

#include <GLES3/gl3.h>

#include <cstring>

namespace fourdvt::gpu {

void readPackBuffer(int offset_bytes, int bytes, void* out) {
  const void* mapped = glMapBufferRange(GL_PIXEL_PACK_BUFFER, offset_bytes, bytes, GL_MAP_READ_BIT);
  if (!mapped) return;
  std::memcpy(out, mapped, static_cast<size_t>(bytes));
  glUnmapBuffer(GL_PIXEL_PACK_BUFFER);
}

}  // namespace fourdvt::gpu
