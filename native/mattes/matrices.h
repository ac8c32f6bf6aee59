// SPDX-License-Identifier: Apache-2.0
// OpenCV views of pictures, and a parallel loop.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "base/image.h"

namespace fourdvt::mattes {

// View of the picture's bytes; valid as long as the picture.
inline cv::Mat matrixOf(const Image& picture) {
  return cv::Mat(picture.height, picture.width, CV_8UC(picture.channels), const_cast<uint8_t*>(picture.pixels.data()));
}

// Calls work(0) … work(count - 1) on OpenCV's threads.
inline void inParallel(size_t count, const std::function<void(size_t)>& work) {
  cv::parallel_for_(cv::Range(0, int(count)), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) work(size_t(i));
  });
}

}  // namespace fourdvt::mattes
