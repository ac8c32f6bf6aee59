// SPDX-License-Identifier: Apache-2.0
// What a context can do, which GLES and WebGL2 say in different ways: gles_caps.cpp; wasm/gles_caps.cpp, where
// extensions must also be switched on.
#pragma once

#include "gpu/device.h"

namespace fourdvt::gpu {

// Of the current context. Errors: GpuFailure without one, or with one below OpenGL ES 3.0.
Result<Caps> readCaps();

}  // namespace fourdvt::gpu
