// SPDX-License-Identifier: Apache-2.0
// Plates for captures without any: background that clips show outside the performer, separated together with the
// performer from frames spread over the take. Initial masks: motion within the region that all cameras see. Then, in
// rounds: colours of object and background per camera, a cut of every frame, the hull of the other cameras' masks, and
// the median of the frames that show the background. Background that the performer always covers stays unknown; its
// colours stand in. Requires static cameras, and no motion but the performer's where all cameras look.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "mattes/background_model.h"
#include "mattes/key_evidence.h"

namespace fourdvt::mattes {

inline constexpr int kClipSamples = 20;        // maximum frames that are sampled
inline constexpr double kClipPixels = 80'000;  // maximum pixels of a sampled frame

struct ClipCamera {
  std::vector<cv::Mat> masks;  // [sample] CV_8U at the reduced size
  ColourCounts colours;        // object and background
  // Most frequent appearance of each neighbourhood at the reduced size, RGB; and the cost as object, nats, where a
  // picture shows it.
  Image usual;
  cv::Mat usual_nats;  // CV_32F
  float noise = 1;     // mean squared difference of two pictures of a static scene, levels²
};

// `pictures`: [camera][sample] RGB of one instant per sample, one size per camera: the calibrated size divided by
// reductionFor(camera, kClipPixels). At least three samples.
std::vector<ClipCamera> separateClips(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m,
                                      const std::vector<std::vector<Image>>& pictures);

// CV_32F, the reduced size: nats against the object where `picture`, RGB of that size, shows the usual appearance.
cv::Mat costOfTheUsual(const ClipCamera& clip, const Image& picture);

// Background behind masks (CV_8U, any size) of the same samples at full size. Known where at least a fifth of the
// samples, and at least three, show it.
BackgroundModel plateBehind(std::span<const Image> pictures, std::span<const cv::Mat> masks);

}  // namespace fourdvt::mattes
