// SPDX-License-Identifier: Apache-2.0
// Conversion of FFmpeg's decoded frames to RGB by their own matrix and range. Private to the files that link FFmpeg.
#pragma once

#include "base/image.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

// Returns true for full range. Unspecified range: full for gray (mattes are coverage, not luma) and RGB, limited for
// YUV.
bool isFullRange(const AVFrame& frame, const AVPixFmtDescriptor& format);

// Returns true for the matrix of standard definition: marked so, or unspecified and of at most 576 lines.
bool isBt601(const AVFrame& frame);

class RgbConverter {
 public:
  // fast: nearest-neighbour chroma upsampling and less exact rounding.
  explicit RgbConverter(bool fast = false) : fast_(fast) {}
  // Converts to 3 channels at the frame's size, its sides divided by `reduce` and rounded down: a pixel is the mean of
  // reduce² pixels. Reuses the memory of `out`. Returns false for formats that FFmpeg cannot convert.
  bool convert(const AVFrame& frame, Image& out, int reduce = 1);

 private:
  bool fast_;
  SwsScaler scaler_;
};

}  // namespace fourdvt::platform
