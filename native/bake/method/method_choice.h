// SPDX-License-Identifier: Apache-2.0
// The rule by which a method is taken. Does NOT draw or measure.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fourdvt::bake {

// Mean over the views that were left out, each against its camera's picture.
struct MethodScore {
  std::string method;
  double cost = 1;  // of a new frame, FVVR's is 1
  double psnr_db = 0,
         ssim = 0;                     // registered, where the view is blended (view_scores.h): these decide
  double own_psnr_db = 0;              // the same with the view's own camera among those that are drawn from
  double psnr_fg_db = 0, ssim_fg = 0;  // over all of the figure, as measure::PictureScore
};

// Its measured values, of which sums and means are made.
template <class Score>
auto measuredOf(Score& s) {
  return std::array{&s.psnr_db, &s.ssim, &s.own_psnr_db, &s.psnr_fg_db, &s.ssim_fg};
}

struct ChoiceRule {
  double most_cost = 2.5;         // FVVR's frames
  double below_linear_db = 0.05;  // never below `linear` by more
  double tie_db = 0.05;           // among equals the cheapest is taken, and of these the first …
  double tie_ssim = 0.004;        // … unless its SSIM is lower by more
  // Corrections for leaving cameras out (algorithms/cameras.md). A visitor's view lies between a camera's own and one
  // that was left out: this share of its squared error is that of the own view, less where cameras are off, and none
  // from so many pixels of shift on, since errors of calibration do not shrink with the angle.
  double own_share = 0.3;
  double own_until_px = 1.5;
  // A search between cameras twice as far apart as a visitor's
  // errs more: added for methods that search along rays, in full from 60° to the next camera, not at all up to 30°.
  double search_db = 0.5;
  // Where cameras are off a mean of more of them is nearer to the truth, which few pixels show: taken off `linear`,
  // which blends fewer, for every pixel of shift.
  double blend_db_per_px = 0.3;
  double most_shift_px = 2;   // beyond it no method is taken that trusts the calibration (trustsCalibration)
  std::string check() const;  // empty, or what is wrong
};

struct MethodVerdict {
  MethodScore score;
  double judged_db = 0;  // psnr_db as the rule corrects it
  std::string verdict;   // "taken", or why not
};

struct MethodChoice {
  std::string method;                   // empty: none was measured
  std::vector<MethodVerdict> verdicts;  // as the scores, and "taken" for one of them
};

// Method that is taken where nothing could be measured: the cheapest, and on no row of site/measured/methods.md more
// than .02 dB below `linear`.
inline constexpr const char* kUnmeasuredMethod = "fvvr";

// Means over the views that were left out.
struct LeftOut {
  double shift_px = 0;  // how far what is drawn for a camera lies from its picture, as a whole
  double gap_deg = 0;   // from its direction to that of the nearest camera that is left, as the surface sees them
};

// `linear` among the scores is what others are held against; without it none is refused for being below it.
MethodChoice chooseMethod(const std::vector<MethodScore>& scores, const LeftOut& views, const ChoiceRule& rule = {});

// How long a new frame takes by each method against FVVR's on the same surface. A stated table (method_costs.inc), so
// that the same capture gives the same character on every machine; `bench_method_costs` measures it again.

// Between the table's sizes linear in their logarithm, beyond them as at the last; at least 1, so that nothing is taken
// for being cheaper than FVVR. Infinite for a method that the table has not.
double methodCost(std::string_view method, size_t faces);

// Returns true for methods that move points along the view's rays to where the cameras agree: with cameras that lie a
// pixel or two off it finds agreement elsewhere, and what it draws is sharp in the wrong place.
bool trustsCalibration(std::string_view method);

// Methods that a capture may be given, by cost: those that were the best of all, or within .05 dB of it, under some
// condition of site/measured/methods.md, but for blurs, which win by PSNR alone where nothing fits.
std::vector<std::string> methodCandidates();

}  // namespace fourdvt::bake
