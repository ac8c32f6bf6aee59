// SPDX-License-Identifier: Apache-2.0
// Cross-validation of Montage4D (Du et al. 2019, Table 2): each input camera's view, drawn without its picture and with
// it, against that picture. Surfaces from pictures are made from all cameras, the left-out one's matte included, as in
// the paper.
#include <limits>

#include "lab/measure/appearance_score.h"
#include "lab/study/projective/projective_study.h"
#include "lab/study/projective/setup.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/run_steps.h"

namespace fourdvt::study {
namespace {

constexpr const char* kCompared[] = {rows::kFvvr, rows::kMethodHoloportation, rows::kMethodMontage};

Condition onProxy(const char* proxy) {
  Condition out;
  out.at = out.proxy = proxy;
  return out;
}

using CrossLanes =
    std::map<std::pair<std::string, int>, measure::AppearanceLane>;  // by method, and 1: with its own picture

Status addFrame(ProjectiveSetup& setup, const Condition& condition, FrameWindow& frames, uint32_t frame,
                const std::vector<std::string>& names, CrossLanes& lanes) {
  FOURDVT_ASSIGN(auto methods, setup.make(names));
  FOURDVT_ASSIGN(const FrameScene scene, setup.scene(condition, frames, frame));
  FOURDVT_TRY(setup.show(condition, scene, setup.cameras()[0]));
  for (size_t c = 0; c < setup.cameras().size(); ++c) {
    FOURDVT_TRY(checkStop(setup.context()));
    FOURDVT_ASSIGN(const auto* captured, frames.at(frame));
    const Image truth = inputTruth(captured->pictures[c]);
    for (const int own : {0, 1}) {
      setup.stage().leaveOut(own ? std::span<const size_t>() : std::span<const size_t>(&c, 1));
      for (const std::string& name : names) {
        FOURDVT_ASSIGN(auto picture, setup.draw(methods[name], condition, scene, setup.cameras()[c], truth,
                                                std::numeric_limits<float>::infinity()));
        lanes[{name, own}].add(truth, std::move(picture));
      }
    }
  }
  return {};
}

Result<Rows> crossValidate(ProjectiveSetup& setup, const Condition& condition, FrameWindow& frames,
                           const std::vector<std::string>& names) {
  CrossLanes lanes;
  for (const uint32_t frame : spreadTestFrames(frames.sequence(), crossFrames(setup.context().options)))
    FOURDVT_TRY(addFrame(setup, condition, frames, frame, names, lanes));
  Rows out;
  for (auto& [key, lane] : lanes) {
    std::vector<measure::AppearanceScore> scores;
    for (const auto& [tag, score] : lane.finish()) scores.push_back(score);
    const measure::AppearanceScore m = measure::meanAppearance(scores);
    const RowWriter row(out, rows::kCross, frames.sequence().name, key.first,
                        "proxy=" + condition.proxy + " own=" + std::to_string(key.second));
    row.add({{rows::kRmse, m.rmse}, {rows::kPsnrFgDb, m.picture.psnr_fg_db}, {rows::kSsimFg, m.picture.ssim_fg}});
  }
  return out;
}

}  // namespace

Result<Rows> runCrossValidation(const StudyContext& context) {
  FOURDVT_ASSIGN(auto setup, ProjectiveSetup::create(context, *context.device));
  std::vector<std::string> names;
  for (const char* name : kCompared)
    for (const std::string& known : setup->methods())
      if (known == name) names.push_back(known);
  std::vector<Condition> conditions{onProxy(rows::kProxyGiven), onProxy(rows::kProxyHull)};
  if (!context.options.quick) conditions.insert(conditions.begin() + 1, onProxy(rows::kProxyRefined));
  const auto sequences = projectiveSequences(context);
  Rows out;
  double done = 0;
  for (const auto* sequence : sequences) {
    FrameWindow frames(*context.capture, *sequence, context.open_video);
    for (const Condition& condition : conditions) {
      reportProgress(context, "", sequence->name + ", " + condition.proxy,
                     done++ / double(sequences.size() * conditions.size()));
      FOURDVT_TRY(addPart(
          context, "cross-" + condition.proxy + "-" + sequence->name,
          [&] { return crossValidate(*setup, condition, frames, names); }, out));
    }
  }
  return out;
}

}  // namespace fourdvt::study
