// SPDX-License-Identifier: Apache-2.0
// Headless GLES 3.0 context (EGL_MESA_platform_surfaceless, else the default display with a pbuffer).
#pragma once

#include <memory>

#include "base/result.h"

namespace fourdvt::platform {

class EglContext {
 public:
  // Makes the new context current on this thread. Errors: GpuFailure, with the packages to install.
  static Result<std::unique_ptr<EglContext>> create();
  virtual ~EglContext() = default;
};

}  // namespace fourdvt::platform
