// SPDX-License-Identifier: Apache-2.0
// Motion classes: mesh blend, alignment against OpenCV and truth, appearance between the members, cost, transitions.
#include <cmath>

#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

Cells weightsOf(const StudyValues& v) { return numbersOf(v, {kMotionAppearance, "", "w", 2, "w = "}); }

// Adds curves over w, one per method.
void addOverW(Section& section, const StudyValues& v, CurvesOptions options) {
  options.x_key = 'w';
  options.x_decimals = 2;
  options.x_label = "w, share of the second member";
  addCurves(section, v, options, methodsOf(v, options.table));
}

void addBlend(Section& section, const StudyValues& v) {
  Cells blends{{{"linear"}, kLinear}};
  for (const double r : v.numbers(kMotionBlend, kHybrid, "references")) {
    const std::string count = fixedText(r, 0), filter = "references=" + count;
    const bool baked = !std::isnan(v.mean(kMotionBlend, kHybrid, filter + " baked=1", kErrorMaxMm));
    blends.push_back({{"hybrid, R = " + count + (baked ? " (as baked)" : "")}, kHybrid, filter});
  }
  blends.push_back({{"non-linear (solver)"}, kNonlinear});
  addGrid(section, v,
          {kMotionBlend,
           "Mesh blend against the non-linear one",
           "Largest and rms vertex distance over phases and weights. Hybrid: linear, and R precomputed corrections. "
           "Times: native, one frame of two members.",
           {"blend"}},
          blends,
          cellsOf({{"max, mm", kErrorMaxMm, fixed<2>},
                   {"rms, mm", kErrorRmsMm, fixed<2>},
                   {"ms a frame", kBlendMs, fixed<3>},
                   {"of the solver's time", kRatioToNonlinear, [](double r) { return percentText(100 * r); }}}));
}

void addFlow(Section& section, const StudyValues& v) {
  const Cells methods = methodsOf(v, kMotionFlow);
  addGrid(section, v,
          {kMotionFlow,
           "Flow against OpenCV's Farnebäck",
           "Distance of the end points on the foreground, between two members' looks on the same mesh and view. "
           "OpenCV's own flow is " +
               fixedText(v.mean(kMotionFlow, kFlowOpencv, "against=none", kDifferenceMeanPx), 2) + " px in the mean.",
           {"method"},
           {.filter = "against=opencv"}},
          methods, cellsOf({{"mean, px", kDifferenceMeanPx, fixed<3>}, {"95 %, px", kDifferenceTailPx, fixed<3>}}));
  addGrid(section, v,
          {kMotionFlow,
           "End-point error against the known displacement",
           "“None”: how far the members' appearance is apart. Flow methods in the picture; the baked alignment "
           "projected into the same views.",
           {"method"},
           {.filter = "against=truth", .text = fixed<2>}},
          methods,
          cellsOf({{"mean, px", kDifferenceMeanPx},
                   {"95 %, px", kDifferenceTailPx},
                   {"mean, mm", kDifferenceMeanMm},
                   {"95 %, mm", kDifferenceTailMm}}));
}

// Adds PSNR and SSIM by w, a row per method.
void addTruth(Section& section, const StudyValues& v, const std::string& filter, const std::string& title,
              const std::string& note) {
  addGrid(section, v,
          {kMotionAppearance, title, note, {"method"}, {.filter = filter, .quantity = kPsnrFgDb, .beside = kSsimFg}},
          methodsOf(v, kMotionAppearance), weightsOf(v));
}

const std::string kScores = "PSNR in dB / SSIM.";

std::string meshNote(const StudyValues& v) {
  std::string note = " Vertices of the blended mesh are from those of the true one, mean / 95th percentile:";
  for (const double w : v.numbers(kMotionAppearance, "", "w")) {
    const auto millimetres = [&](const char* quantity) {
      return fixedText(v.mean(kMotionAppearance, "", "w=" + fixedText(w, 2) + " !mesh", quantity), 1);
    };
    note.append(" ").append(millimetres(kMeshMeanMm)).append(" / ").append(millimetres(kMeshTailMm));
    note.append(" mm at w = ").append(fixedText(w, 2)).append(",");
  }
  note.back() = '.';
  return note +
         " The class's common time comes from its members' poses, the studio's is its actor's phase: an instant of the "
         "truth is looked up where the members' own phases are, in the w-weighted mean, the instant's: the mesh "
         "between two frames of the class, pictures at the nearest.";
}

void addAppearance(Section& section, const StudyValues& v) {
  const std::string judged = "mesh=truth region=common";
  addOverW(section, v,
           {.table = kMotionAppearance,
            .quantity = kPsnrFgDb,
            .title = "4DVT Fig. 8: PSNR against the truth, true mesh",
            .y_label = "PSNR, common foreground, dB",
            .filter = judged});
  addOverW(section, v,
           {.table = kMotionAppearance,
            .quantity = kSsimFg,
            .title = "SSIM against the truth, true mesh",
            .y_label = "SSIM, common foreground",
            .filter = judged});
  addTruth(section, v, judged, "Truth, drawn on the true mesh, common foreground: appearance alone", kScores);
  addTruth(section, v, "mesh=blend region=common", "Truth, drawn on the blended mesh, common foreground",
           kScores + meshNote(v));
  addTruth(section, v, "mesh=blend region=whole", "Truth, drawn on the blended mesh, whole foreground", kScores);
  addOverW(section, v,
           {.table = kMotionSharpness,
            .quantity = kGradientRatio,
            .title = "Gradient energy against the members' own",
            .y_label = "ratio"});
  addGrid(
      section, v,
      {kMotionSharpness,
       "Sharpness half way, against the members' own looks",
       "Mean squared gradient of the blend over that of both members' looks on the same mesh and view; detail: "
       "the same of the Laplacian. 1: as sharp as the sources. Averaging lowers it even where all is aligned "
       "(baked-mean), for noise and folds of two sources differ; baked puts that much contrast back. "
       "flow-gpu-detail: the same put back in the flow's picture, in this study only; compare baked with it, and "
       "baked-mean with flow-gpu.",
       {"method"},
       {.filter = "w=0.50", .text = fixed<3>}},
      methodsOf(v, kMotionSharpness),
      cellsOf(
          {{"gradient energy", kGradientRatio}, {"worst view", kGradientRatioLeast}, {"detail energy", kDetailRatio}}));
}

void addCost(Section& section, const StudyValues& v) {
  for (const std::string& size : v.settings(kMotionCost, "", "size"))
    addGrid(section, v,
            {kMotionCost,
             "Drawing a blend of two members, " + size,
             "Medians of one run, the variants taking turns. Characters: how many with baked alignment, each fully "
             "shaded, take as long as one with run-time flow.",
             {"method"},
             {.filter = "size=" + size + " !characters", .text = fixed<2>}},
            methodsOf(v, kMotionCost),
            cellsOf({{"ms a frame", kFrameMs},
                     {"× plain blend", kRatioToNone},
                     {"characters for one of flow-gpu", kCharactersPerFlow}}));
}

// Rows of a table with this quantity: a row per sequence and setting, titled by the sequence or keys of the setting.
Cells casesOf(const StudyValues& v, const char* table, const char* quantity, const std::vector<std::string>& keys) {
  Cells out;
  for (const Row& row : v.rows()) {
    if (row.table != table || row.quantity != quantity) continue;
    Cell cell{.filter = row.setting, .sequence = row.sequence};
    for (const std::string& key : keys) {
      const std::string text = key == "sequence" ? row.sequence : settingText(row.setting, key);
      cell.title.push_back(text.empty() ? "–" : text);
    }
    out.push_back(std::move(cell));
  }
  return out;
}

void addTransitions(Section& section, const StudyValues& v) {
  addGrid(section, v,
          {kMotionTransitions,
           "Transitions",
           "Latency: from the request to the first frame in which the target is seen (bound 0.4 s), and the fit, as "
           "the motion graph plans them from every frame; played: what the player takes, preparation and ticks "
           "included. Step and change: the furthest that a vertex moves and the mean that the picture changes from "
           "one tick of 40 ms to the next during the transition, over the most in the two motions by themselves "
           "(travel left out).",
           {"from", "to"}},
          casesOf(v, kMotionTransitions, kLatencyMeanS, {"from", "to"}),
          cellsOf({{"latency, mean", kLatencyMeanS},
                   {"max", kLatencyMaxS},
                   {"played, mean", kLatencyPlayedMeanS},
                   {"max", kLatencyPlayedS},
                   {"fit, mean mm", kFitMeanMm},
                   {"max mm", kFitMaxMm},
                   {"step mm", kStepMm},
                   {"of own", kStepMm, fixed<2>, kOwnStepMm},
                   {"change, levels", kChangeLevels},
                   {"of own", kChangeLevels, fixed<2>, kOwnChangeLevels}}));
  addGrid(section, v,
          {kMotionSkate,
           "Feet on the ground while travelling",
           "How far a vertex strays over the ground while it stands, by contact: the player travels at 25 ticks a "
           "second.",
           {"state", "at"}},
          casesOf(v, kMotionSkate, kSkateMeanMm, {"sequence", "at"}),
          cellsOf({{"contacts", kContacts, fixed<0>},
                   {"mean, mm", kSkateMeanMm},
                   {"95 %, mm", kSkateTailMm},
                   {"max, mm", kSkateMaxMm}}));
}

}  // namespace

void fillMotion(Section& section, const StudyValues& v) {
  addBlend(section, v);
  addFlow(section, v);
  addAppearance(section, v);
  addCost(section, v);
  addTransitions(section, v);
  if (!section.tables.empty())
    section.tables.insert(section.tables.begin(), judgementTable(judgeMotion(v), "Goals of motion"));
}

}  // namespace fourdvt::study
