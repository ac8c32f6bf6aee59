// SPDX-License-Identifier: Apache-2.0
// The key of background_key.h in steps, so that other evidence can join in between: other cameras, hints. Masks are
// CV_8U, 255 on the object, the picture's size.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "capture/background_key.h"
#include "capture/key_evidence.h"

namespace fourdvt::capture {

class KeyCut {
 public:
  // `picture` has 3 channels and the plates' size.
  KeyCut(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options = {});
  ~KeyCut();
  KeyCut(KeyCut&&) noexcept;
  KeyCut& operator=(KeyCut&&) noexcept;

  // The cheapest mask. `more_cost`: CV_32F, nats that a pixel costs more as object; may be empty.
  cv::Mat cut(const cv::Mat& more_cost = {}) const;
  // The same where `near` (CV_8U) is not 0; elsewhere the mask stays as `given`.
  cv::Mat cutNear(const cv::Mat& given, const cv::Mat& near, const cv::Mat& more_cost = {}) const;
  // Learns colours and shadows anew from a mask.
  void learn(const cv::Mat& object);
  // Adds the picture's colours to `counts` by a mask; or takes the colours from such counts, of other pictures too.
  void count(const cv::Mat& object, ColourCounts& counts) const;
  void use(const ColourCounts& counts);
  // The mask without specks, with a ramp of about a pixel at its outline. One channel.
  Image matte(cv::Mat object) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fourdvt::capture
