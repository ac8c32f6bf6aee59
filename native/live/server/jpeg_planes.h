// SPDX-License-Identifier: Apache-2.0
// Decodes a camera's JPEG to its planes, without a change of colours. Does NOT take other samplings than 4:2:0.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/result.h"

namespace fourdvt::live {

// BT.601, full range. Chroma planes are half as large, rounded up.
struct JpegPlanes {
  int width = 0, height = 0;
  const uint8_t *y = nullptr, *u = nullptr, *v = nullptr;
  int stride_y = 0, stride_u = 0, stride_v = 0;  // bytes
};

class JpegDecoder {
 public:
  // Errors: Unsupported (this FFmpeg has no decoder).
  static Result<std::unique_ptr<JpegDecoder>> create();
  virtual ~JpegDecoder() = default;
  // Valid until the next call. Errors: FileUnreadable (damaged, another size, or not 4:2:0).
  virtual Result<JpegPlanes> decode(std::span<const uint8_t> jpeg, int width, int height) = 0;
};

}  // namespace fourdvt::live
