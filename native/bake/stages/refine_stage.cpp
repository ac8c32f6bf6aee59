// SPDX-License-Identifier: Apache-2.0
#include "bake/run/job.h"
#include "bake/stages/stages.h"
#include "base/hash.h"
#include "base/text.h"
#include "platform/files.h"
#include "refine/refine.h"
#include "store/folder.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kRefineVersion = "refine 3";  // change it whenever results of older builds must not be reused

}  // namespace

std::string refinementPath(const std::string& folder, const capture::Capture& capture,
                           const refine::RefineOptions& options) {
  std::string key = kRefineVersion;
  for (const capture::CaptureSequence& sequence : capture.sequences) key += sequence.name + filesKey(capture, sequence);
  const std::string text = printed(" outline %d cameras %d bias %.9g", int(options.outline), int(options.cameras),
                                   options.matte_bias_pixels.value_or(1e9));
  return store::keyedPath(folder, "refinement", key + text);
}

Result<refine::Refinement> loadOrRefine(const std::string& path, const capture::Capture& capture,
                                        const refine::RefineOptions& options, const OpenVideo& open_video,
                                        const std::function<bool(const std::string& what, double share)>& on_progress) {
  if (auto kept = refine::loadRefinement(path, capture)) return kept;
  return refine::refineCapture(capture, open_video, options, on_progress);
}

Status keepRefinement(const std::string& path, const refine::Refinement& refinement) {
  return store::save(path, refinement);
}

Status refineJob(BakeRun& run) {
  Job& job = run.job;
  if (!job.options.refine.any()) return {};
  job.refinement_path = refinementPath(job.surveyFolder(), job.capture, job.options.refine);
  StageProgress progress(run.progress, infoOf(Stage::Refine).work_s * job.total_frames);
  StageClock::Span span(run.clock, Stage::Refine);
  const auto tell = [&](const std::string& what, double share) {
    progress.done(share, "refine " + what);
    return !run.stopped();
  };
  refine::Refinement refinement;
  if (run.environment.refinement) {
    refinement = *run.environment.refinement;
  } else {
    FOURDVT_ASSIGN(refinement, loadOrRefine(job.refinement_path, job.capture, job.options.refine,
                                            run.environment.open_video, tell));
  }
  refine::applyRefinement(refinement, job.capture);
  job.cameras = refinement.cameras;
  job.refinement = std::move(refinement);
  return planSurface(job, run.environment);
}

bool loadRefinementPictures(Job& job) {
  if (!job.refinement || job.refinement->worst.empty()) return true;
  auto kept = refine::loadRefinement(job.refinement_path, job.capture);
  if (!kept || refine::changeHash(kept.value()) != refine::changeHash(*job.refinement)) return false;
  job.refinement->worst = std::move(kept.value().worst);
  return true;
}

Status keepRefinement(const BakeRun& run) {
  const Job& job = run.job;
  if (!job.refinement || run.environment.refinement) return {};
  FOURDVT_TRY(platform::makeFolder(job.surveyFolder()));
  return keepRefinement(job.refinement_path, *job.refinement);
}

}  // namespace fourdvt::bake
