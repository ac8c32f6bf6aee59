// SPDX-License-Identifier: Apache-2.0
// Cameras, pictures and plates at a reduced size.
#pragma once

#include <opencv2/core.hpp>

#include "base/opencv_image.h"
#include "capture/capture.h"
#include "mattes/background_model.h"

namespace fourdvt::mattes {

// Smallest integer by which a camera's pictures are reduced to at most `pixels`; 1 where they are small enough.
int reductionFor(const capture::CaptureCamera& camera, double pixels);
cv::Size reducedSize(int width, int height, int reduction);
capture::CaptureCamera reduced(const capture::CaptureCamera& camera, int reduction);
Image reduced(const Image& picture, int reduction);
BackgroundModel reduced(const BackgroundModel& plates, int reduction);
// Resizes a mask (CV_8U, 0 or 255).
cv::Mat resizedMask(const cv::Mat& mask, const cv::Size& size);

}  // namespace fourdvt::mattes
