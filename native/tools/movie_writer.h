// SPDX-License-Identifier: Apache-2.0
// RGB pictures → H.264 .mp4 (libx264, BT.709 limited range, 4:2:0, faststart). The file appears under its name only
// when finish() succeeded.
#pragma once

#include <memory>
#include <string>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::tools {

class MovieWriter {
 public:
  // Even sides. Errors: WriteFailed, Unsupported (no H.264 encoder in this FFmpeg).
  static Result<std::unique_ptr<MovieWriter>> create(const std::string& path, int width, int height, double fps);
  virtual ~MovieWriter() = default;
  // 3 or 4 channels; alpha is composited over black.
  virtual Status write(const Image& picture) = 0;
  virtual Status finish() = 0;
};

}  // namespace fourdvt::tools
