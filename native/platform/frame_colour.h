// SPDX-License-Identifier: Apache-2.0
// FFmpeg's decoded frames → RGB by their own matrix and range. Private to the files that link FFmpeg.
#pragma once

#include "base/image.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

// Unspecified range: full for gray (mattes are coverage, not luma) and RGB, limited for YUV.
bool isFullRange(const AVFrame& frame, const AVPixFmtDescriptor& format);

// The matrix of standard definition: by its mark, or unspecified and of at most 576 lines.
bool isBt601(const AVFrame& frame);

class RgbConverter {
 public:
  // fast: each chroma sample's colour is repeated, and sums are rounded less exactly.
  explicit RgbConverter(bool fast = false) : fast_(fast) {}
  // Gives `out` 3 channels and the frame's size, its sides divided by `reduce` and rounded down: a pixel is the mean of
  // reduce² pixels. Its memory is used again. False for formats that FFmpeg does not convert.
  bool convert(const AVFrame& frame, Image& out, int reduce = 1);

 private:
  bool fast_;
  SwsScaler scaler_;
};

}  // namespace fourdvt::platform
