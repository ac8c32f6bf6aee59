// SPDX-License-Identifier: Apache-2.0
// Slopes of pictures.
#pragma once

#include <opencv2/core.hpp>

namespace fourdvt::capture {

// CV_32F: the largest squared slope of the three channels per pixel, levels²; by Sobel's filter. `levels`: CV_32FC3.
cv::Mat squaredGradient(const cv::Mat& levels);

}  // namespace fourdvt::capture
