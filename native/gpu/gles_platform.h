// SPDX-License-Identifier: Apache-2.0
// Calls that differ between GLES 3.0 and WebGL2: gles_platform.cpp, wasm/gles_platform.cpp. Private to gles_device.cpp.
#pragma once

#include "gpu/device.h"

namespace fourdvt::gpu {

// Reads the capabilities of the current context; WebGL2: also enables extensions. Errors: GpuFailure without a context,
// or with one below OpenGL ES 3.0.
Result<Caps> readCaps();

// Copies bytes from the buffer bound to GL_PIXEL_PACK_BUFFER.
void readPackBuffer(int offset_bytes, int bytes, void* out);

}  // namespace fourdvt::gpu
