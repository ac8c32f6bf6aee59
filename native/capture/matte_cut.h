// SPDX-License-Identifier: Apache-2.0
// The cheapest split of a picture into object and background for given costs per pixel and per border, by one minimum
// cut. Does NOT know what the costs mean.
#pragma once

#include <opencv2/core.hpp>

namespace fourdvt::capture {

struct CutCosts {
  cv::Mat object_minus_background;  // CV_32F: what a pixel costs more as object than as background
  // CV_32F: cost of a border between a pixel and its neighbour to the right, below, below right, and below left.
  cv::Mat right, down, down_right, down_left;
};

// CV_8U: 255 object, 0 background. Pixels where `open` (CV_8U) is 0 stay as `given` (CV_8U) has them; the border costs
// between them and open ones count.
cv::Mat cheapestCut(const CutCosts& costs, const cv::Mat& given, const cv::Mat& open);

}  // namespace fourdvt::capture
