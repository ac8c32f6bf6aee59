// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/image.h"

namespace fourdvt {

// View of the picture's bytes; valid as long as the picture.
inline cv::Mat matrixOf(const Image& picture) {
  return cv::Mat(picture.height, picture.width, CV_8UC(picture.channels), const_cast<uint8_t*>(picture.pixels.data()));
}

}  // namespace fourdvt
