// SPDX-License-Identifier: Apache-2.0
// Per-pixel evidence for object and for background (lit as the plate, or a scaled plate: shadow and highlight). Colours
// of the object and shadow ratios are learnt from the picture itself.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mattes/background_model.h"

namespace fourdvt::mattes {

struct BackgroundKeyOptions {
  float min_shadow = 0.2f;      // minimum ratio of shadowed background to its plate (encoded values)
  float max_highlight = 1.25f;  // maximum ratio of highlights
  float smoothness = 2.2f;      // cost of a border between object and background per pixel of its length, in nats
  int rounds = 2;               // re-estimations of the object's colours and the shadow's ratio
  float speck_share = 1e-4f;    // minimum size of parts and holes, as a share of the picture; at least 12 pixels
  float blur_pixels = 0.7f;     // softness of the outline where picture and plate leave it undetermined
};

// Colour counts, [red][green][blue] of kColourBins bins each, over one or several pictures of one camera.
inline constexpr int kColourBins = 24;
struct ColourCounts {
  std::vector<float> object, background;
};

// Evidence of one picture. All deviations are in units of the sensor's noise per channel.
class KeyEvidence {
 public:
  KeyEvidence(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options);

  // CV_8U: 255 where a neighbourhood of 5 × 5 pixels cannot be a scaled plate.
  const cv::Mat& surelyObject() const { return object_; }
  // CV_8U: 255 where a neighbourhood of 5 × 5 pixels looks like the plate.
  const cv::Mat& surelyLit() const { return lit_; }
  // CV_8U: 255 where the plates show the background; empty: everywhere. Elsewhere the learnt background colours replace
  // the plates.
  const cv::Mat& known() const { return known_; }
  // Learns colours of the object from the pixels of `object` (CV_8U), and those of the background and the shadow's
  // ratios from the others.
  void learn(const cv::Mat& object);
  // Adds the picture's colours; `object` is not 0 on the object.
  void count(const cv::Mat& object, ColourCounts& counts) const;
  // Replaces the colours by these counts.
  void use(const ColourCounts& counts);
  // CV_32F: cost as object minus cost as background, nats.
  cv::Mat cost() const;
  // CV_32F: maximum-likelihood ratio of background to plate: 1, or that of a shadow.
  cv::Mat ratio() const;

  const cv::Mat& picture() const { return picture_; }  // CV_32FC3
  const cv::Mat& plate() const { return plate_; }      // CV_32FC3
  // CV_32F: variance of picture minus plate.
  const cv::Mat& variance() const { return variance_; }

 private:
  static constexpr int kRatios = 96, kWidths = 12, kColours = kColourBins;
  void measureNoise(const cv::Mat& picture, const cv::Mat& mean);
  struct Fit {
    cv::Mat lit, scaled;  // CV_32F: mean squared deviations of a neighbourhood, 1 ± √(2 / number of values) for a fit
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
  const float plate_noise_;  // the mean plate's variance as a share of the picture's
  cv::Vec3f noise_;          // levels
  cv::Mat picture_, plate_, variance_, extra_;
  cv::Mat object_, lit_, shaded_;
  cv::Mat lit_share_, shaded_share_;  // CV_32F: factors of both hypotheses, by their fit to the neighbourhoods
  std::vector<float> ratios_;         // [width][ratio] density
  cv::Mat known_;
  std::vector<float> colours_;  // [bin] density of the object, in units of noise
  std::vector<float> others_;   // [bin] density of the background, for pixels without plates
};

}  // namespace fourdvt::mattes
