// SPDX-License-Identifier: Apache-2.0
#include "evaluate/study_labels.h"

#include <algorithm>
#include <thread>

#include "bake/labels/labelling.h"
#include "evaluate/study_common.h"
#include "evaluate/study_rows.h"
#include "evaluate/study_scene.h"
#include "evaluate/study_steps.h"

namespace fourdvt::evaluate {
namespace {

constexpr size_t kHysteresisFrames = 2;  // to each side, as the bake's survey

struct Measured {
  std::vector<std::vector<float>> fractions;  // per frame: [camera][face]
  std::vector<Positions> positions;
};

Result<Measured> measureFrames(const StudyContext& context, const bake::Job& job,
                               const capture::CaptureSequence& sequence, uint32_t frames) {
  auto baker =
      bake::FrameBaker::create(*context.device, job.cameras, job.mesh.decoded.topology, job.mesh.decoded.positions, {});
  if (!baker) return baker.error();
  auto reader = capture::FrameReader::open(*context.capture, sequence, context.open_video);
  if (!reader) return reader.error();
  Measured out;
  for (uint32_t f = 0; f < frames; ++f) {
    FOURDVT_TRY(checkStop(context));
    auto frame = reader.value()->next();
    if (!frame) return frame.error();
    setBakerFrame(*baker.value(), job, frame.value());
    auto fractions = baker.value()->measureVisibility();
    if (!fractions) return fractions.error();
    out.fractions.push_back(fractions.take());
    out.positions.push_back(bake::reordered(job.mesh, frame.value().positions));
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

}  // namespace

Result<Figures> compareSolves(const StudyContext& context) {
  const capture::CaptureSequence& sequence = shortestSequence(context);
  const uint32_t frames = std::min(sequence.frame_count, kGlobalFrames);
  bake::BakeOptions bake_options = studyBake(context, "solves");
  bake_options.sequences = {sequence.name};
  auto surveyed = surveyOnly(context, bake_options);
  if (!surveyed) return surveyed.error();
  const bake::Job& job = surveyed.value()->job;
  auto measured = measureFrames(context, job, sequence, frames);
  if (!measured) return measured.error();
  const bake::FaceGraph graph = bake::makeFaceGraph(job.mesh.decoded.topology);
  Figures out;
  for (const char* solve : {"solve=windowed", "solve=global"}) {
    bake::LabelOptions options;
    options.layers = kPaperLayers;
    options.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    if (std::string(solve) == "solve=global") options.window_frames = options.hop_frames = static_cast<int>(frames);
    auto statistics = bake::solveLabels(
        options, graph, frames,
        [&](uint32_t f) -> Result<bake::FaceCosts> { return costsOf(measured.value(), job, f); },
        [](uint32_t, const std::vector<uint8_t>&) -> Status { return {}; }, {}, context.stop);
    if (!statistics) return statistics.error();
    RowWriter(out, rows::kLabels, sequence.name, rows::kJoint, solve).add(rows::kEnergy, statistics.value().energy, "");
  }
  return out;
}

}  // namespace fourdvt::evaluate
