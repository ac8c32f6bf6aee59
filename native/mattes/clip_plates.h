// SPDX-License-Identifier: Apache-2.0
// Plates for captures that have none: the background as clips show it where the performer is not, found together with
// the performer from frames spread over the take. First guess: what moves, where all cameras look. Then, in rounds:
// colours of object and background per camera, a cut of every frame, the hull of the other cameras' masks, and the
// median of the frames that show the background. Does NOT know the background where the performer never leaves: there
// its colours stand in. Cameras stand still, and nothing but the performer moves where all cameras look.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "mattes/background_model.h"
#include "mattes/key_evidence.h"

namespace fourdvt::mattes {

inline constexpr int kClipSamples = 20;        // frames that are looked at, at most
inline constexpr double kClipPixels = 80'000;  // … at this size at most

struct ClipCamera {
  std::vector<cv::Mat> masks;  // [sample] CV_8U at the reduced size
  ColourCounts colours;        // of object and background
  // The look that a neighbourhood has most often, at the reduced size: RGB, and nats against the object where it has
  // it.
  Image usual;
  cv::Mat usual_nats;  // CV_32F
  float noise = 1;     // mean squared difference of two pictures of one thing, levels²
};

// `pictures`: [camera][sample] RGB of one instant per sample, all of a camera's of one size, which is its calibrated
// one divided by reductionFor(camera, kClipPixels). At least three samples.
std::vector<ClipCamera> separateClips(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m,
                                      const std::vector<std::vector<Image>>& pictures);

// CV_32F, the reduced size: nats against the object where a picture, RGB of that size, shows what it usually shows.
cv::Mat costOfTheUsual(const ClipCamera& clip, const Image& picture);

// The background behind masks (CV_8U, any size) of the same samples at full size. Known where a fifth of them show it,
// and three at least.
BackgroundModel plateBehind(std::span<const Image> pictures, std::span<const cv::Mat> masks);

}  // namespace fourdvt::mattes
