// SPDX-License-Identifier: Apache-2.0
// What each pixel of a picture says for object and for background (lit as the plate, or a scaled plate: shadow and
// highlight). The colours of the object and the ratios of the shadows are learnt from the picture itself.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mattes/background_model.h"

namespace fourdvt::mattes {

struct BackgroundKeyOptions {
  float min_shadow = 0.2f;      // background may be darker than its plate down to this ratio (encoded values)
  float max_highlight = 1.25f;  // … and brighter up to this one
  float smoothness = 2.2f;      // cost of a border between object and background per pixel of its length, in nats
  int rounds = 2;               // how often the object's colours and the shadow's ratio are learnt anew
  float speck_share = 1e-4f;    // parts and holes of less than this share of the picture, or of less than 12 pixels, go
  float blur_pixels = 0.7f;     // the outline's softness where picture and plate do not tell it
};

// How often colours were seen, [red][green][blue] of kColourBins bins each: of several pictures of one camera, say.
inline constexpr int kColourBins = 24;
struct ColourCounts {
  std::vector<float> object, background;
};

// Everything is divided by the sensor's noise per channel: a deviation of 1 is one standard deviation.
class KeyEvidence {
 public:
  KeyEvidence(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options);

  // CV_8U: 255 where a neighbourhood of 5 × 5 can be no scaled plate.
  const cv::Mat& surelyObject() const { return object_; }
  // CV_8U: 255 where a neighbourhood of 5 × 5 looks as the plate does.
  const cv::Mat& surelyLit() const { return lit_; }
  // CV_8U: 255 where the plates show the background; empty: everywhere. Elsewhere the colours of the background that
  // was learnt stand in for the plates.
  const cv::Mat& known() const { return known_; }
  // Learns the colours of the object from the pixels of `object` (CV_8U), those of the background and the shadow's
  // ratios from outside it.
  void learn(const cv::Mat& object);
  // Adds the picture's colours, those of the object where `object` is not 0.
  void count(const cv::Mat& object, ColourCounts& counts) const;
  // Takes the colours from these counts.
  void use(const ColourCounts& counts);
  // CV_32F: cost of being the object less the cost of being background, in nats.
  cv::Mat cost() const;
  // CV_32F: the most likely ratio of background and plate: 1, or that of a shadow.
  cv::Mat ratio() const;

  const cv::Mat& picture() const { return picture_; }  // CV_32FC3
  const cv::Mat& plate() const { return plate_; }      // CV_32FC3
  // CV_32F: variance of picture less plate.
  const cv::Mat& variance() const { return variance_; }

 private:
  static constexpr int kRatios = 96, kWidths = 12, kColours = kColourBins;
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
  std::vector<float> counted(const cv::Mat& mask, bool unsure_counts_less) const;
  std::vector<float> densityOf(std::vector<float> counts) const;
  void learnRatios(const cv::Mat& object);
  float objectDensity(const cv::Vec3f& colour) const;
  size_t colourBin(const cv::Vec3f& colour) const;

  const BackgroundKeyOptions options_;
  const float plate_noise_;  // the mean plate's variance, of the picture's
  cv::Vec3f noise_;          // levels
  cv::Mat picture_, plate_, variance_, extra_;
  cv::Mat object_, lit_, shaded_;
  cv::Mat lit_share_, shaded_share_;  // CV_32F: what the neighbourhoods leave of the two hypotheses
  std::vector<float> ratios_;         // [width][ratio] density
  cv::Mat known_;
  std::vector<float> colours_;  // [bin] density of the object, in units of noise
  std::vector<float> others_;   // [bin] density of the background, where the plates do not show it
};

}  // namespace fourdvt::mattes
