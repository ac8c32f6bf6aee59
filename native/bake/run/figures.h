// SPDX-License-Identifier: Apache-2.0
// Measurements of a finished bake, for its report.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bake/labels/labelling.h"
#include "bake/method/method_choice.h"
#include "refine/refine.h"

namespace fourdvt::bake {

// Rendering method of a character from cameras unless --method or the viewer sets another, and its scores.
struct ChosenMethod {
  std::string method;
  std::optional<double> sweep_band_m;  // for a person (render::SweepOptions); none: the player's default
  MethodChoice choice;                 // without verdicts: nothing was measured
  size_t frames = 0, views = 0;
  double shift_px = 0;  // mean shift of a camera's rendered view against its picture
  double gap_deg = 0;   // LeftOut
  double most_cost = 0;
};

struct ClassSummary {
  std::vector<std::string> members;
  struct Parameter {
    std::string name;
    double min = 0, max = 0;
  };
  std::vector<Parameter> parameters;
  uint32_t references = 0;                        // corrections of the mesh blend per frame
  double linear_error_m = 0, hybrid_error_m = 0;  // largest vertex distances from the non-linear blend
  bool aligned = false;
};

struct BakeReport {
  std::map<std::string, double> seconds_by_stage;
  uint32_t frames = 0;  // all sequences and classes
  uint64_t peak_rss_bytes = 0;
  std::map<std::string, uint64_t> bytes_by_part;
  std::map<std::string, LabelStatistics> labels_by_sequence;
  std::map<std::string, ClassSummary> classes;
  std::optional<refine::Refinement> refinement;  // none: not selected
  std::optional<ChosenMethod> method;            // from cameras
  std::vector<std::string> notes;                // for the user, one sentence each
};

}  // namespace fourdvt::bake
