// SPDX-License-Identifier: Apache-2.0
// Calls in which GLES 3.0 and WebGL2 differ: gles_platform.cpp, wasm/gles_platform.cpp. Private to gles_device.cpp.
#pragma once

#include "gpu/device.h"

namespace fourdvt::gpu {

// Reads the capabilities of the current context; WebGL2: switches extensions on. Errors: GpuFailure without one, or with one
// below OpenGL ES 3.0.
Result<Caps> readCaps();

// Copies bytes out of the buffer that is bound to GL_PIXEL_PACK_BUFFER.
void readPackBuffer(int offset_bytes, int bytes, void* out);

}  // namespace fourdvt::gpu
