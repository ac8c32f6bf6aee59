// SPDX-License-Identifier: Apache-2.0
// Mattes in front of a natural background: separates objects that are absent from the plates from walls and floors of
// any texture; shadows and highlights of the object count as background. Room and camera must stand still, and exposure
// and white balance must match the plates: see fitPlate. Uses one camera and one frame; colour spill stays. Method and
// sources: algorithms/mattes.md.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "base/image.h"
#include "mattes/background_model.h"
#include "mattes/key_evidence.h"

namespace fourdvt::mattes {

// `picture` has 3 channels and the plates' size. Returns 1 channel, 255 on the object, with a ramp of about a pixel at
// its outline; all 0 without an object. Holes, e.g. between arm and body, stay holes.
Image backgroundKey(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options = {});

// backgroundKey in steps, between which evidence of other cameras and hints can be added. Masks are CV_8U, 255 on the
// object, the picture's size.
class KeyCut {
 public:
  // `picture` has 3 channels and the plates' size.
  KeyCut(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options = {});
  ~KeyCut();
  KeyCut(KeyCut&&) noexcept;
  KeyCut& operator=(KeyCut&&) noexcept;

  // Minimum-cost mask. `more_cost`: CV_32F, additional nats per pixel as object; may be empty.
  cv::Mat cut(const cv::Mat& more_cost = {}) const;
  // Minimum-cost mask where `near` (CV_8U) is not 0; elsewhere `given`.
  cv::Mat cutNear(const cv::Mat& given, const cv::Mat& near, const cv::Mat& more_cost = {}) const;
  // Re-estimates colours and shadow ratios from a mask.
  void learn(const cv::Mat& object);
  // Adds the picture's colours to `counts`, split by a mask.
  void count(const cv::Mat& object, ColourCounts& counts) const;
  void use(const ColourCounts& counts);
  // Mask without specks, with a ramp of about a pixel at its outline. One channel.
  Image matte(cv::Mat object) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

struct CutCosts {
  cv::Mat object_minus_background;  // CV_32F: cost as object minus cost as background
  // CV_32F: cost of a border between a pixel and its neighbour to the right, below, below right, and below left.
  cv::Mat right, down, down_right, down_left;
};

// Returns CV_8U: 255 object, 0 background. Pixels with `open` (CV_8U) 0 keep their label of `given` (CV_8U); border
// costs between them and open pixels count.
cv::Mat cheapestCut(const CutCosts& costs, const cv::Mat& given, const cv::Mat& open);

}  // namespace fourdvt::mattes
