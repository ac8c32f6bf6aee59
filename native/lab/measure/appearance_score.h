// SPDX-License-Identifier: Apache-2.0
// What PSNR and SSIM do not tell apart in a drawn picture: blur, texture that is sharp but out of place, and flicker.
// Does NOT draw.
#pragma once

#include <deque>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "lab/measure/motion_metrics.h"
#include "measure/picture_score.h"

namespace fourdvt::measure {

// Root mean square of the differences of encoded RGB, 0…1 (M4D Table 2). NaN for an empty region.
double rmse(const Image& a, const Image& b, const Mask& inside);

// Gradient energy of the picture over that of the truth (Sharpness::gradient), RGB. Below 1: blurred; above 1: seams,
// ghosts, noise. NaN for an empty region and where the truth is flat.
double gradientRatio(const Image& truth, const Image& picture, const Mask& inside);

// PSNR of the picture when every block of it may lie elsewhere: each block of `block_px`² pixels of the truth is
// compared with the picture at all shifts of up to ±reach_px in x and y, and the best one counts. By blocks, since
// wrong depth and calibration move parts of a picture differently. Never below psnr(). RGB; 100 dB for equal pictures,
// NaN for an empty region.
struct ShiftTolerance {
  int reach_px = 3, block_px = 16;
};
double shiftTolerantPsnr(const Image& truth, const Image& picture, const Mask& inside,
                         const ShiftTolerance& tolerance = {});

// How the surface that a fixed camera sees moves from one frame to the next: surfaceFlow, NaN also where the point is
// hidden in the next frame.
FlowField visibleMotion(const PinholeCamera& camera, const std::vector<glm::uvec3>& faces, const Positions& before,
                        const Positions& now);

// One picture with its truth, RGBA straight alpha.
struct TrueAndDrawn {
  Image truth, picture;
};
// Temporal flicker between consecutive frames of a fixed view: the mean of |e_now(x + m) − e_before(x)| in levels over
// the three channels, e the error picture − truth over black and m the motion of the surface under x. An error that
// stays, or that rides on the surface, does not count; one that comes, goes or crawls does. Where motion is known and
// all four pictures show the performer; NaN where that is nowhere.
double flickerLevels(const TrueAndDrawn& before, const TrueAndDrawn& now, const FlowField& motion);

// All measures of one picture. rmse, shift_tolerant_db: on the union of both silhouettes; gradient_ratio: where both
// are, two pixels away from the outline.
struct AppearanceScore {
  PictureScore picture;
  double rmse = 0, gradient_ratio = 0, shift_tolerant_db = 0;
};
// RGBA straight alpha, of one size.
AppearanceScore scoreAppearance(const Image& truth, const Image& picture);
// NaN fields are left out of their mean; NaN if nothing is left.
AppearanceScore meanAppearance(const std::vector<AppearanceScore>& scores);

// Scores on other threads while the caller draws on; at most a few pictures wait.
class AppearanceLane {
 public:
  void add(Image truth, Image picture, const std::string& tag = {});
  // Waits for all. Scores with their tags in order of add.
  std::vector<std::pair<std::string, AppearanceScore>> finish();

 private:
  static constexpr size_t kWaiting = 4;
  void collect(size_t keep);
  std::deque<std::pair<std::string, std::future<AppearanceScore>>> running_;
  std::vector<std::pair<std::string, AppearanceScore>> finished_;
};

}  // namespace fourdvt::measure
