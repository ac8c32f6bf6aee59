// SPDX-License-Identifier: Apache-2.0
#include "lab/study/steps/labels.h"

#include <algorithm>
#include <thread>

#include "bake/labels/labelling.h"
#include "lab/labels/paper_labellings.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "mattes/frame_reader.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr size_t kHysteresisFrames = 2;  // on each side, as in the bake's survey

struct Measured {
  std::vector<std::vector<float>> fractions;  // per frame: [camera][face]
  std::vector<Positions> positions;
};

Result<Measured> measureFrames(const StudyContext& context, const bake::Job& job,
                               const capture::CaptureSequence& sequence, uint32_t frames) {
  FOURDVT_ASSIGN(auto baker, makeBaker(context, job, {}));
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(*context.capture, sequence, context.open_video));
  Measured out;
  for (uint32_t f = 0; f < frames; ++f) {
    FOURDVT_TRY(checkStop(context));
    FOURDVT_ASSIGN(auto frame, reader->next());
    setBakerFrame(*baker, job, frame);
    FOURDVT_ASSIGN(auto fractions, baker->measureVisibility());
    out.fractions.push_back(std::move(fractions));
    out.positions.push_back(bake::reordered(job.mesh, frame.positions));
  }
  return out;
}

bake::FaceCosts costsOf(const Measured& measured, const bake::Job& job, uint32_t frame) {
  const size_t first = frame - std::min<size_t>(frame, kHysteresisFrames);
  const size_t count = std::min(measured.fractions.size(), frame + kHysteresisFrames + 1) - first;
  bake::FaceCostOptions options;
  options.penalty = job.options.penalty;
  const auto window = std::span(measured.fractions).subspan(first, count);
  return bake::measureFaceCosts(options, job.cameras, job.mesh.decoded.topology, measured.positions[frame],
                                bake::steadyFractions(window, frame - first, options));
}

// Labelling problem of a sequence's first frames.
struct LabelProblem {
  const StudyContext& context;
  const bake::Job& job;
  std::string sequence;
  Measured measured;
  bake::FaceGraph graph;

  uint32_t frameCount() const { return static_cast<uint32_t>(measured.positions.size()); }
  Result<bake::LabelStatistics> solve(bake::LabelOptions options) const {
    options.layers = kPaperLayers;
    options.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    return bake::solveLabels(options, graph, frameCount(),
                             {[&](uint32_t f) -> Result<bake::FaceCosts> { return costsOf(measured, job, f); },
                              [](uint32_t, const std::vector<uint8_t>&) -> Status { return {}; },
                              {},
                              context.stop});
  }
};

struct LabelVariant {
  const char* name;
  bake::LabelOptions options;
};

Status compareParts(const LabelProblem& problem, Rows& out) {
  const std::vector<LabelVariant> variants{{kNaive, {.rule = &lab::kNaive}},
                                           {kSpatial, {.rule = &lab::kSpatial}},
                                           {kTemporalPaper, {.rule = &lab::kTemporalPaper}},
                                           {kJoint, {}},
                                           {kJointNoUnseen, {.label_unseen = false}},
                                           {kJointNoPartial, {.use_partial = false}},
                                           {kJointNeither, {.use_partial = false, .label_unseen = false}}};
  for (const LabelVariant& variant : variants) {
    FOURDVT_ASSIGN(auto statistics, problem.solve(variant.options));
    writeLabelRows(statistics, kLabelParts, problem.sequence, variant.name, out);
  }
  return {};
}

Status compareSolves(const LabelProblem& problem, Rows& out) {
  for (const bool is_global : {false, true}) {
    bake::LabelOptions options;
    if (is_global) options.window_frames = options.hop_frames = static_cast<int>(problem.frameCount());
    FOURDVT_ASSIGN(auto statistics, problem.solve(options));
    RowWriter(out, kLabels, problem.sequence, kJoint, is_global ? "solve=global" : "solve=windowed")
        .add({{kEnergy, statistics.energy}});
  }
  return {};
}

}  // namespace

void writeLabelRows(const bake::LabelStatistics& s, const std::string& table, const std::string& sequence,
                    const std::string& method, Rows& out) {
  for (size_t l = 0; l < s.seam_percent.size(); ++l) {
    const RowWriter row(out, table, sequence, method, "layer=" + std::to_string(l + 1));
    row.add({{kSeamPercent, s.seam_percent[l]},
             {kFlipPercent, s.flip_percent[l]},
             {kSeenSeamPercent, s.seen_seam_percent[l]},
             {kSeenFlipPercent, s.seen_flip_percent[l]},
             {kMeanPenalty, s.mean_penalty[l]}});
  }
}

Result<Rows> measureLabels(const StudyContext& context) {
  const capture::CaptureSequence& sequence = shortestSequence(context);
  const uint32_t frames = std::min(sequence.frame_count, context.options.quick ? kQuickFrames : kGlobalFrames);
  bake::BakeOptions bake_options = studyBake(context, "solves");
  bake_options.sequences = {sequence.name};
  FOURDVT_ASSIGN(auto surveyed, surveyOnly(context, bake_options));
  const bake::Job& job = surveyed->job;
  FOURDVT_ASSIGN(auto measured, measureFrames(context, job, sequence, frames));
  const LabelProblem problem{context, job, sequence.name, std::move(measured),
                             bake::makeFaceGraph(job.mesh.decoded.topology)};
  Rows out;
  FOURDVT_TRY(compareParts(problem, out));
  if (!context.options.quick) FOURDVT_TRY(compareSolves(problem, out));
  return out;
}

}  // namespace fourdvt::study
