// SPDX-License-Identifier: Apache-2.0
// The rule by which a method is taken. Does NOT draw or measure.
#pragma once

#include <string>
#include <vector>

namespace fourdvt::bake {

// Mean over the views that were left out, each against its camera's picture.
struct MethodScore {
  std::string method;
  double cost = 1;  // of a new frame, FVVR's is 1
  double psnr_db = 0,
         ssim = 0;  // registered (registration.h), where the view is blended (shared_sight.h): these decide
  double psnr_fg_db = 0, ssim_fg = 0;  // over all of the figure, as measure::PictureScore
};

struct ChoiceRule {
  double most_cost = 2.5;         // FVVR's frames
  double below_linear_db = 0.05;  // never below `linear` by more
  double tie_db = 0.05;           // among equals the cheapest is taken, and of these the first …
  double tie_ssim = 0.004;        // … unless its SSIM is lower by more
  double most_shift_px = 2;       // beyond it no method is taken that trusts the calibration (method_costs.h)
  std::string check() const;      // empty, or what is wrong
};

struct MethodVerdict {
  MethodScore score;
  std::string verdict;  // "taken", or why not
};

struct MethodChoice {
  std::string method;                   // empty: none was measured
  std::vector<MethodVerdict> verdicts;  // as the scores, and "taken" for one of them
};

// What is taken where nothing could be measured: the cheapest, and on no row of site/measured/methods.md more than .02
// dB below `linear`.
inline constexpr const char* kUnmeasuredMethod = "fvvr";

// shift_px: how far what is drawn for a camera lies from its picture, as a whole. `linear` among the scores is what
// others are held against; without it none is refused for being below it.
MethodChoice chooseMethod(const std::vector<MethodScore>& scores, double shift_px, const ChoiceRule& rule = {});

}  // namespace fourdvt::bake
