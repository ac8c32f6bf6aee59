// SPDX-License-Identifier: Apache-2.0
// Mattes in front of a natural background: tells what was not in the room when its plates were taken, in front of walls
// and floors of any texture, with the object's shadows and highlights counted as background. The room and the camera
// must stand still, and exposure and white balance must be those of the plates: see fitPlate. Does NOT look at other
// cameras or other frames, and does NOT remove colour spill. Method and sources: algorithms/mattes.md.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "base/image.h"
#include "mattes/background_model.h"
#include "mattes/key_evidence.h"

namespace fourdvt::mattes {

// `picture` has 3 channels and the plates' size. Returns 1 channel, 255 on the object, with a ramp of about a pixel at
// its outline; all 0 if nothing stands in front of the background. Holes, e.g. between arm and body, stay holes.
Image backgroundKey(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options = {});

// The same key in steps, so that other evidence can join in between: other cameras, hints. Masks are CV_8U, 255 on the
// object, the picture's size.
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

struct CutCosts {
  cv::Mat object_minus_background;  // CV_32F: what a pixel costs more as object than as background
  // CV_32F: cost of a border between a pixel and its neighbour to the right, below, below right, and below left.
  cv::Mat right, down, down_right, down_left;
};

// CV_8U: 255 object, 0 background. Pixels where `open` (CV_8U) is 0 stay as `given` (CV_8U) has them; the border costs
// between them and open ones count.
cv::Mat cheapestCut(const CutCosts& costs, const cv::Mat& given, const cv::Mat& open);

}  // namespace fourdvt::mattes
