// SPDX-License-Identifier: Apache-2.0
// Capabilities of a context, read in different ways from GLES and WebGL2: gles_caps.cpp; wasm/gles_caps.cpp, which also
// switches extensions on.
#pragma once

#include "gpu/device.h"

namespace fourdvt::gpu {

// Reads those of the current context. Errors: GpuFailure without one, or with one below OpenGL ES 3.0.
Result<Caps> readCaps();

}  // namespace fourdvt::gpu
