// SPDX-License-Identifier: Apache-2.0
// Motion classes: mesh blend, alignment against OpenCV and truth, appearance between the members, cost, transitions.
#include <cmath>

#include "evaluate/study_report_sections.h"
#include "evaluate/study_rows.h"

namespace fourdvt::evaluate {
namespace {

using Texts = std::vector<std::string>;

std::string two(double v) { return fixedText(v, 2); }
std::string three(double v) { return fixedText(v, 3); }

struct Column {
  const char *title, *quantity;
  std::string (*text)(double value);
};

// A row a method, a column a quantity; methods without any figure are left out.
void addMethods(Section& section, const StudyValues& v, Table table, const char* rows_table, const std::string& filter,
                const std::vector<Column>& columns) {
  for (const Column& column : columns) table.columns.push_back(column.title);
  for (const std::string& method : v.methods(rows_table)) {
    Texts row{methodTitle(method)};
    bool any = false;
    for (const Column& column : columns) {
      const double value = v.mean(rows_table, method, filter, column.quantity);
      any |= !std::isnan(value);
      row.push_back(column.text(value));
    }
    if (any) table.rows.push_back(std::move(row));
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

std::vector<Curve> curvesByW(const StudyValues& v, const char* table, const std::string& filter, const char* quantity) {
  std::vector<Curve> curves;
  for (const std::string& method : v.methods(table)) {
    Curve curve{methodTitle(method), {}};
    for (const double w : v.numbers(table, method, "w")) {
      const double value = v.mean(table, method, "w=" + two(w) + " " + filter, quantity);
      if (!std::isnan(value)) curve.points.emplace_back(w, value);
    }
    if (!curve.points.empty()) curves.push_back(std::move(curve));
  }
  return curves;
}

void addPlot(Section& section, const std::string& title, const std::string& y, std::vector<Curve> curves) {
  if (!curves.empty())
    section.plots.push_back({title, "w, share of the second member", y, false, false, std::move(curves)});
}

void addBlend(Section& section, const StudyValues& v) {
  Table table{"Mesh blend against the non-linear one",
              "Largest and rms vertex distance over phases and weights. Hybrid: linear, and R precomputed corrections. "
              "Times: native, one frame of two members.",
              {"blend", "max, mm", "rms, mm", "ms a frame", "of the solver's time"},
              {}};
  const auto addRow = [&](const std::string& title, const char* method, const std::string& filter) {
    const auto at = [&](const char* quantity) { return v.mean(rows::kMotionBlend, method, filter, quantity); };
    if (std::isnan(at(rows::kBlendMs))) return;
    table.rows.push_back({title, two(at(rows::kErrorMaxMm)), two(at(rows::kErrorRmsMm)), three(at(rows::kBlendMs)),
                          percentText(100 * at(rows::kRatioToNonlinear))});
  };
  addRow("linear", rows::kLinear, "");
  for (const double r : v.numbers(rows::kMotionBlend, rows::kHybrid, "references")) {
    const std::string filter = "references=" + fixedText(r, 0);
    const bool baked = !std::isnan(v.mean(rows::kMotionBlend, rows::kHybrid, filter + " baked=1", rows::kErrorMaxMm));
    addRow("hybrid, R = " + fixedText(r, 0) + (baked ? " (as baked)" : ""), rows::kHybrid, filter);
  }
  addRow("non-linear (solver)", rows::kNonlinear, "");
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

void addFlow(Section& section, const StudyValues& v) {
  addMethods(section, v,
             {"Flow against OpenCV's Farnebäck",
              "Distance of the end points on the foreground, between two members' looks on the same mesh and view. "
              "OpenCV's own flow is " +
                  two(v.mean(rows::kMotionFlow, rows::kFlowOpencv, "against=none", rows::kDifferenceMeanPx)) +
                  " px in the mean.",
              {"method"},
              {}},
             rows::kMotionFlow, "against=opencv",
             {{"mean, px", rows::kDifferenceMeanPx, three}, {"95 %, px", rows::kDifferenceTailPx, three}});
  addMethods(section, v,
             {"End-point error against the known displacement",
              "“None”: how far the members' appearance is apart. Flow methods in the picture; the baked alignment "
              "projected into the same views.",
              {"method"},
              {}},
             rows::kMotionFlow, "against=truth",
             {{"mean, px", rows::kDifferenceMeanPx, two},
              {"95 %, px", rows::kDifferenceTailPx, two},
              {"mean, mm", rows::kDifferenceMeanMm, two},
              {"95 %, mm", rows::kDifferenceTailMm, two}});
}

// PSNR and SSIM by w, a row a method.
void addTruthTable(Section& section, const StudyValues& v, const std::string& filter, const std::string& title,
                   const std::string& note) {
  const auto weights = v.numbers(rows::kMotionAppearance, "", "w");
  Table table{title, note, {"method"}, {}};
  for (const double w : weights) table.columns.push_back("w = " + two(w));
  for (const std::string& method : v.methods(rows::kMotionAppearance)) {
    Texts row{methodTitle(method)};
    bool any = false;
    for (const double w : weights) {
      const std::string setting = "w=" + two(w) + " " + filter;
      row.push_back(two(v.mean(rows::kMotionAppearance, method, setting, rows::kPsnrFgDb)) + " / " +
                    fixedText(v.mean(rows::kMotionAppearance, method, setting, rows::kSsimFg), 4));
      any |= !std::isnan(v.mean(rows::kMotionAppearance, method, setting, rows::kPsnrFgDb));
    }
    if (any) table.rows.push_back(std::move(row));
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

constexpr const char* kScores = "PSNR in dB / SSIM.";

std::string meshNote(const StudyValues& v) {
  std::string note = " Vertices of the blended mesh are from those of the true one, mean / 95th percentile:";
  for (const double w : v.numbers(rows::kMotionAppearance, "", "w")) {
    const auto millimetres = [&](const char* quantity) {
      return fixedText(v.mean(rows::kMotionAppearance, "", "w=" + two(w) + " !mesh", quantity), 1);
    };
    note +=
        " " + millimetres(rows::kMeshMeanMm) + " / " + millimetres(rows::kMeshTailMm) + " mm at w = " + two(w) + ",";
  }
  note.back() = '.';
  return note +
         " The class's common time comes from its members' poses, the studio's is its actor's phase: an instant of the "
         "truth is looked up where the members' own phases are, in the w-weighted mean, the instant's: the mesh "
         "between "
         "two frames of the class, pictures at the nearest.";
}

void addAppearance(Section& section, const StudyValues& v) {
  const std::string judged = "mesh=truth region=common";
  addPlot(section, "4DVT Fig. 8: PSNR against the truth, true mesh", "PSNR, common foreground, dB",
          curvesByW(v, rows::kMotionAppearance, judged, rows::kPsnrFgDb));
  addPlot(section, "SSIM against the truth, true mesh", "SSIM, common foreground",
          curvesByW(v, rows::kMotionAppearance, judged, rows::kSsimFg));
  addTruthTable(section, v, judged, "Truth, drawn on the true mesh, common foreground: appearance alone", kScores);
  addTruthTable(section, v, "mesh=blend region=common", "Truth, drawn on the blended mesh, common foreground",
                std::string(kScores) + meshNote(v));
  addTruthTable(section, v, "mesh=blend region=whole", "Truth, drawn on the blended mesh, whole foreground", kScores);
  addPlot(section, "Gradient energy against the members' own", "ratio",
          curvesByW(v, rows::kMotionSharpness, "", rows::kGradientRatio));
  addMethods(
      section, v,
      {"Sharpness half way, against the members' own looks",
       "Mean squared gradient of the blend over that of both members' looks on the same mesh and view; detail: "
       "the same of the Laplacian. 1: as sharp as the sources. Averaging lowers it even where all is aligned "
       "(baked-mean), for noise and folds of two sources differ; baked puts that much contrast back. "
       "flow-gpu-detail: the same put back in the flow's picture, in this study only; compare baked with it, and "
       "baked-mean with flow-gpu.",
       {"method"},
       {}},
      rows::kMotionSharpness, "w=0.50",
      {{"gradient energy", rows::kGradientRatio, three},
       {"worst view", rows::kGradientRatioLeast, three},
       {"detail energy", rows::kDetailRatio, three}});
}

void addCost(Section& section, const StudyValues& v) {
  for (const std::string& size : v.settings(rows::kMotionCost, "", "size"))
    addMethods(section, v,
               {"Drawing a blend of two members, " + size,
                "Medians of one run, the variants taking turns. Characters: how many with baked alignment, each fully "
                "shaded, take as long as one with run-time flow.",
                {"method"},
                {}},
               rows::kMotionCost, "size=" + size + " !characters",
               {{"ms a frame", rows::kFrameMs, two},
                {"× plain blend", rows::kRatioToNone, two},
                {"characters for one of flow-gpu", rows::kCharactersPerFlow, two}});
}

void addTransitions(Section& section, const StudyValues& v) {
  Table table{"Transitions",
              "Latency: from the request to the first frame in which the target is seen (bound 0.4 s), and the fit, as "
              "the motion graph plans them from every frame; played: what the player takes, preparation and ticks "
              "included. Step and change: the furthest that a vertex moves and the mean that the picture changes from "
              "one tick of 40 ms to the next during the transition, over the most in the two motions by themselves "
              "(travel left out).",
              {"from", "to", "latency, mean", "max", "played, mean", "max", "fit, mean mm", "max mm", "step mm",
               "of own", "change, levels", "of own"},
              {}};
  for (const Figure& row : v.rows()) {
    if (row.table != rows::kMotionTransitions || row.quantity != rows::kLatencyMeanS) continue;
    const auto at = [&](const char* quantity) {
      return v.of(rows::kMotionTransitions, row.sequence, "", row.setting, quantity);
    };
    table.rows.push_back({rows::settingText(row.setting, "from"), rows::settingText(row.setting, "to"),
                          secondsText(row.value), secondsText(at(rows::kLatencyMaxS)),
                          secondsText(at(rows::kLatencyPlayedMeanS)), secondsText(at(rows::kLatencyPlayedS)),
                          fixedText(at(rows::kFitMeanMm), 1), fixedText(at(rows::kFitMaxMm), 1),
                          fixedText(at(rows::kStepMm), 1), two(at(rows::kStepMm) / at(rows::kOwnStepMm)),
                          two(at(rows::kChangeLevels)), two(at(rows::kChangeLevels) / at(rows::kOwnChangeLevels))});
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
  Table skate{"Feet on the ground while travelling",
              "How far a vertex strays over the ground while it stands, by contact: the player travels at 25 ticks a "
              "second.",
              {"state", "at", "contacts", "mean, mm", "95 %, mm", "max, mm"},
              {}};
  for (const Figure& row : v.rows()) {
    if (row.table != rows::kMotionSkate || row.quantity != rows::kSkateMeanMm) continue;
    const auto at = [&](const char* quantity) {
      return v.of(rows::kMotionSkate, row.sequence, "", row.setting, quantity);
    };
    const std::string where = rows::settingText(row.setting, "at");
    skate.rows.push_back({row.sequence, where.empty() ? "–" : where, fixedText(at(rows::kContacts), 0),
                          fixedText(row.value, 1), fixedText(at(rows::kSkateTailMm), 1),
                          fixedText(at(rows::kSkateMaxMm), 1)});
  }
  if (!skate.rows.empty()) section.tables.push_back(std::move(skate));
}

}  // namespace

Section motionSection(const StudyValues& v) {
  Section section{"motion", "Motion", "", {}, {}, {}, {}};
  section.text =
      "4DVT 5–6: a motion class, one character between its members. Methods of bringing the members' appearance "
      "together: none (plain blend), Farnebäck and DIS as GPU passes, OpenCV's own on read-back pictures, and the "
      "alignment baked into the stream.\n\nThe truth between the members exists for captures of the virtual studio "
      "only. To judge appearance and not the silhouette, pictures are compared where both show the character; the "
      "whole foreground is given as well.";
  addBlend(section, v);
  addFlow(section, v);
  addAppearance(section, v);
  addCost(section, v);
  addTransitions(section, v);
  section.pictures = picturesOf(v, {rows::kPictureMotionColumns, rows::kPictureMotionCrops, rows::kPictureTransition});
  if (!section.tables.empty())
    section.tables.insert(section.tables.begin(), judgementTable(judgeMotion(v), "Goals of motion"));
  return section;
}

}  // namespace fourdvt::evaluate
