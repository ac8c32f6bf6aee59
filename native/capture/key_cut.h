// SPDX-License-Identifier: Apache-2.0
// The steps of backgroundKey, for callers that add evidence of their own between them: cut, learn, cut again, matte.
#pragma once

#include "capture/background_key.h"
#include "capture/key_evidence.h"
#include "capture/matte_cut.h"

namespace fourdvt::capture {

class KeyCut {
 public:
  // `picture`: 3 channels, the plates' size.
  KeyCut(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options = {});
  // CV_8U, 255 on the object. `more`: CV_32F, nats that a pixel costs more as object; empty: none. Pixels whose wide
  // surroundings look as the plate does stay background.
  cv::Mat cut(const cv::Mat& more = {}) const;
  // Learns the object's colours and the shadow's ratios from a mask, less its rim.
  void learn(const cv::Mat& mask);
  // Without specks, with a ramp of about a pixel at its outline.
  Image matte(cv::Mat mask) const;

 private:
  BackgroundKeyOptions options_;
  KeyEvidence evidence_;
  CutCosts borders_;
  cv::Mat open_;  // CV_8U: pixels that the cut decides
};

}  // namespace fourdvt::capture
