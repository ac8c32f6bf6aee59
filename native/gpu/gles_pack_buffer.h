// SPDX-License-Identifier: Apache-2.0
// The one call in which GLES 3.0 and WebGL2 differ. Private to gles_device.cpp.
#pragma once

namespace fourdvt::gpu {

// Copies bytes out of the buffer that is bound to GL_PIXEL_PACK_BUFFER. GLES: gles_pack_buffer.cpp maps it; WebGL2:
// wasm/gles_pack_buffer.cpp has getBufferSubData.
void readPackBuffer(int offset_bytes, int bytes, void* out);

}  // namespace fourdvt::gpu
