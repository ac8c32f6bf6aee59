// SPDX-License-Identifier: Apache-2.0
// Appearance errors that PSNR and SSIM confuse: blur, sharp but displaced texture, and flicker.
#pragma once

#include <vector>

#include "lab/measure/motion_metrics.h"
#include "measure/picture_score.h"

namespace fourdvt::measure {

// Root mean square of the differences of encoded RGB, 0…1 (Montage4D, Du et al. 2019, Table 2). NaN for an empty
// region.
double rmse(const Image& a, const Image& b, const Mask& inside);

// Gradient energy of the picture over that of the truth (Sharpness::gradient), RGB. Below 1: blurred; above 1: seams,
// ghosts, noise. NaN for an empty region or a constant truth.
double gradientRatio(const Image& truth, const Image& picture, const Mask& inside);

// Shift-tolerant PSNR: each block of `block_px`² pixels of the truth is compared with the picture at all shifts of up
// to ±reach_px in x and y, and the best one counts. Per block, since wrong depth and calibration displace parts of a
// picture differently. Never below psnr(). RGB; 100 dB for equal pictures, NaN for an empty region.
struct ShiftTolerance {
  int reach_px = 3, block_px = 16;
};
double shiftTolerantPsnr(const Image& truth, const Image& picture, const Mask& inside,
                         const ShiftTolerance& tolerance = {});

// Motion of the visible surface from one frame to the next in a fixed camera: surfaceFlow, NaN also for points occluded
// in the next frame.
FlowField visibleMotion(const PinholeCamera& camera, const std::vector<glm::uvec3>& faces, const Positions& before,
                        const Positions& now);

// Picture and its truth, RGBA straight alpha.
struct TrueAndDrawn {
  Image truth, picture;
};
// Temporal flicker between consecutive frames of a fixed view: the mean of |e_now(x + m) − e_before(x)| in levels over
// the three channels, with e the error picture − truth over black and m the motion of the surface under x. Errors that
// are static or attached to the surface cancel; those that appear, vanish or drift count. Averaged over pixels with
// known motion inside all four silhouettes; NaN without such pixels.
double flickerLevels(const TrueAndDrawn& before, const TrueAndDrawn& now, const FlowField& motion);

// All measures of one picture. rmse, shift_tolerant_db: on the union of both silhouettes; gradient_ratio: on their
// intersection, two pixels away from the outline.
struct AppearanceScore {
  PictureScore picture;
  double rmse = 0, gradient_ratio = 0, shift_tolerant_db = 0;
};
// RGBA straight alpha, of one size.
AppearanceScore scoreAppearance(const Image& truth, const Image& picture);
// Excludes NaN fields from their mean; NaN if none remain.
AppearanceScore meanAppearance(const std::vector<AppearanceScore>& scores);

using AppearanceLane = Lane<AppearanceScore, scoreAppearance>;

}  // namespace fourdvt::measure
