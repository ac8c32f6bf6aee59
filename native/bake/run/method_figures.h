// SPDX-License-Identifier: Apache-2.0
// Method that a character from cameras is drawn by unless --method or the viewer sets another, and its scores.
#pragma once

#include <optional>
#include <string>

#include "bake/method/method_choice.h"

namespace fourdvt::bake {

struct ChosenMethod {
  std::string method;
  std::optional<double> sweep_band_m;  // of a person (render::SweepOptions); none: the player's default
  MethodChoice choice;                 // without verdicts: nothing was measured
  size_t frames = 0, views = 0;
  double shift_px = 0;  // how far what is drawn for a camera lies from its picture, mean
  double gap_deg = 0;   // LeftOut
  double most_cost = 0;
};

}  // namespace fourdvt::bake
