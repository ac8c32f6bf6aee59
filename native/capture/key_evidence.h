// SPDX-License-Identifier: Apache-2.0
// What each pixel of a picture says for object and for background (lit as the plate, or a scaled plate: shadow and
// highlight). The colours of the object and the ratios of the shadows are learnt from the picture itself.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "capture/background_key.h"

namespace fourdvt::capture {

// Everything is divided by the sensor's noise per channel: a deviation of 1 is one standard deviation.
class KeyEvidence {
 public:
  KeyEvidence(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options);

  // CV_8U: 255 where a neighbourhood of 5 × 5 can be no scaled plate.
  const cv::Mat& surelyObject() const { return object_; }
  // CV_8U: 255 where a neighbourhood of 5 × 5 looks as the plate does.
  const cv::Mat& surelyLit() const { return lit_; }
  // Learns the colours of the object from the pixels of `object` (CV_8U), and the shadow's ratios from textured
  // neighbourhoods outside it.
  void learn(const cv::Mat& object);
  // CV_32F: cost of being the object less the cost of being background, in nats.
  cv::Mat cost() const;
  // CV_32F: the most likely ratio of background and plate: 1, or that of a shadow.
  cv::Mat ratio() const;

  const cv::Mat& picture() const { return picture_; }  // CV_32FC3
  const cv::Mat& plate() const { return plate_; }      // CV_32FC3
  // CV_32F: variance of picture less plate.
  const cv::Mat& variance() const { return variance_; }

 private:
  static constexpr int kRatios = 96, kWidths = 12, kColours = 24;
  void measureNoise(const cv::Mat& picture, const cv::Mat& mean);
  struct Fit {
    cv::Mat lit, scaled;  // CV_32F: mean squared deviations of a neighbourhood, 1 ± √(2 / number of values) if it fits
  };
  Fit fit(int window) const;
  void lookAtNeighbourhoods();
  float ratioDensity(float ratio, float deviation) const;
  struct Background {
    float lit = 0, shaded = 0, ratio = 1;  // densities, and the shadow's ratio
  };
  Background backgroundAt(int i) const;
  float objectDensity(const cv::Vec3f& colour) const;
  size_t colourBin(const cv::Vec3f& colour) const;

  const BackgroundKeyOptions options_;
  const float plate_noise_;  // the mean plate's variance, of the picture's
  cv::Vec3f noise_;    // levels
  cv::Mat picture_, plate_, variance_, extra_;
  cv::Mat object_, lit_, shaded_;
  cv::Mat lit_share_, shaded_share_;  // CV_32F: what the neighbourhoods leave of the two hypotheses
  std::vector<float> ratios_;         // [width][ratio] density
  std::vector<float> colours_;        // [bin] density of the object, in units of noise
};

}  // namespace fourdvt::capture
