// SPDX-License-Identifier: Apache-2.0
// Rule that selects the rendering method from measured scores, and the methods' costs.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fourdvt::bake {

// Mean scores over the left-out views, each against its camera's picture.
struct MethodScore {
  std::string method;
  double cost = 1;  // time of a new frame, relative to FVVR's
  double psnr_db = 0,
         ssim = 0;         // registered, in the blended part of the view (view_scores.h): the rule's criteria
  double own_psnr_db = 0;  // the same, rendered with the view's own camera included
  double psnr_fg_db = 0, ssim_fg = 0;  // over the whole figure, see measure::PictureScore
};

// Measured fields, for sums and means.
template <class Score>
auto measuredOf(Score& s) {
  return std::array{&s.psnr_db, &s.ssim, &s.own_psnr_db, &s.psnr_fg_db, &s.ssim_fg};
}

struct ChoiceRule {
  double most_cost = 2.5;         // relative to FVVR's frames
  double below_linear_db = 0.05;  // maximum deficit against `linear`
  double tie_db =
      0.05;  // methods within it are equal: the cheapest of them is selected, the first of equally cheap ones …
  double tie_ssim = 0.004;  // … unless its SSIM is lower by more
  // Corrections for leaving cameras out (algorithms/cameras.md). A visitor's view lies between a camera's own view
  // and a left-out one: this share of its squared error is that of the own view. The share falls with the calibration
  // error to 0 at `own_until_px` pixels of shift, since errors of calibration do not shrink with the angle.
  double own_share = 0.3;
  double own_until_px = 1.5;
  // Compensation for methods that search along rays, whose error grows with the distance between cameras, here twice
  // a visitor's: added in full from 60° to the next camera, not at all up to 30°.
  double search_db = 0.5;
  // With calibration errors a mean of more cameras is nearer to the truth, which few pixels show: subtracted from
  // `linear`, which blends fewer, per pixel of shift.
  double blend_db_per_px = 0.3;
  double max_shift_px = 2;    // maximum for methods that rely on the calibration (trustsCalibration)
  std::string check() const;  // empty, or an error message
};

struct MethodVerdict {
  MethodScore score;
  double judged_db = 0;  // psnr_db after the rule's corrections
  std::string verdict;   // "taken", or the reason against it
};

struct MethodChoice {
  std::string method;                   // empty: none was measured
  std::vector<MethodVerdict> verdicts;  // in the order of the scores, "taken" for one of them
};

// Fallback without measurements: the cheapest method, and on no row of site/measured/methods.md more than .02 dB
// below `linear`.
inline constexpr const char* kUnmeasuredMethod = "fvvr";

// Means over the left-out views.
struct LeftOut {
  double shift_px = 0;  // mean translation between a camera's rendered view and its picture
  double gap_deg = 0;   // angle between its direction and that of the nearest remaining camera, seen from the surface
};

// Selects a method by the rule. Without `linear` among the scores, the other methods have no lower bound.
MethodChoice chooseMethod(const std::vector<MethodScore>& scores, const LeftOut& views, const ChoiceRule& rule = {});

// Time of a new frame by each method relative to FVVR's on the same surface. A fixed table (method_costs.inc), so
// that the same capture gives the same character on every machine; `bench_method_costs` measures it again.

// Interpolates the table linearly in the logarithm of the number of faces, constant beyond its ends; at least 1, so
// that no method gains from being cheaper than FVVR. Infinite for methods outside the table.
double methodCost(std::string_view method, size_t faces);

// True for methods that move points along the view's rays to positions of photo-consistency: with cameras that are
// off by a pixel or two they converge to wrong positions, and the result is sharp in the wrong place.
bool trustsCalibration(std::string_view method);

// Candidate methods of a capture, by cost: those that were the best of all, or within .05 dB of it, under some
// condition of site/measured/methods.md, except for blurs, which win by PSNR alone on misaligned captures.
std::vector<std::string> methodCandidates();

}  // namespace fourdvt::bake
