// SPDX-License-Identifier: Apache-2.0
// Fine detail of a texture layer over the frames of a GOP (algorithms/texels.md). On the surface it hardly changes from
// frame to frame, while every picture samples it at other places, blurred and with noise: the mean over the frames
// resolves more. CPU only.
#pragma once

#include <opencv2/core.hpp>

#include "base/image.h"

namespace fourdvt::bake {

class DetailMean {
 public:
  // Adds a frame's layer: RGB, square, filled; all of one size.
  void add(const Image& layer);
  // Returns the layer with the mean detail, amplified, instead of its own where the two agree.
  Image sharpened(const Image& layer) const;

 private:
  cv::Mat sum_;  // levels
  int frames_ = 0;
};

}  // namespace fourdvt::bake
