// SPDX-License-Identifier: Apache-2.0
// The recipe: validate → warp → survey → every missing GOP, frame by frame → align → graph → assemble.
#include "bake/bake.h"

#include <algorithm>

#include "bake/run/progress.h"
#include "bake/run/work_folder.h"
#include "bake/stages/align_stage.h"
#include "bake/stages/assemble.h"
#include "bake/stages/gop_stage.h"
#include "bake/stages/graph_stage.h"
#include "bake/stages/stream_plan.h"
#include "bake/stages/survey.h"
#include "bake/stages/validate.h"
#include "platform/folders.h"

namespace fourdvt::bake {
namespace {

// What is expected of every stage, before the first of them begins.
void expectWork(const Job& job, ProgressReporter& progress) {
  uint32_t phases = 0, member_phases = 0;
  for (const capture::CaptureClass* c : bakedClasses(job)) {
    const uint32_t frames = expectedPhases(job, *c);
    phases += frames;
    member_phases += frames * static_cast<uint32_t>(c->members.size());
  }
  progress.frames_total = job.total_frames + phases;
  progress.expect(StageWork::kWarp * member_phases + StageWork::kSurvey * job.total_frames +
                  StageWork::kFrame * (job.total_frames + member_phases) + StageWork::kGraph * progress.frames_total);
  if (job.options.align) progress.expect(StageWork::kAlign * (member_phases - phases));
}

Status warp(Job& job, const BakeEnvironment& environment, StageClock& clock, ProgressReporter& progress) {
  StageClock::Span span(clock, "warp");
  double work = 0;
  for (const capture::CaptureClass* c : bakedClasses(job))
    work += StageWork::kWarp * expectedPhases(job, *c) * c->members.size();
  StageProgress stage(progress, work);
  return planStreams(job, environment,
                     [&](const std::string& name, double share) { stage.done(share, "warp " + name); });
}

Result<Survey> survey(const Job& job, const BakeEnvironment& environment, StageClock& clock,
                      ProgressReporter& progress) {
  StageProgress stage(progress, StageWork::kSurvey * job.total_frames);
  return Survey::run(job, environment, clock, [&](const std::string& name, double share) { stage.done(share, name); });
}

Status bakeGops(const Job& job, const Survey& survey, const WorkFolder& work, const BakeEnvironment& environment,
                StageClock& clock, ProgressReporter& progress, bool& resumed) {
  GopStage gops(job, survey, work, environment, clock, progress);
  FOURDVT_TRY(gops.start());
  FOURDVT_TRY(gops.run());
  resumed = gops.framesBaked() < job.streamFrames();
  return {};
}

// Each once: a class says of its members what they say themselves.
std::vector<std::string> notesOf(const Job& job) {
  std::vector<std::string> notes;
  for (const StreamPlan& plan : job.streams)
    for (const std::string& note : plan.motion.notes)
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  return notes;
}

Result<BakeReport> runJob(Job& job, const BakeEnvironment& environment, StageClock& clock) {
  ProgressReporter progress(environment);
  expectWork(job, progress);
  FOURDVT_TRY(warp(job, environment, clock, progress));
  auto opened = WorkFolder::open(job.workFolder(), settingsKey(job), job.options.resume);
  if (!opened) return opened.error();
  const WorkFolder& work = opened.value();
  auto surveyed = survey(job, environment, clock, progress);
  if (!surveyed) return surveyed.error();
  ReportInput report;
  FOURDVT_TRY(bakeGops(job, surveyed.value(), work, environment, clock, progress, report.resumed));
  FOURDVT_TRY(alignClasses(job, work, environment, clock, progress));
  auto graph = makeGraph(job, work, environment, clock, progress);
  if (!graph) return graph.error();
  {
    StageClock::Span span(clock, "assemble");
    FOURDVT_TRY(assemble(job, work, graph.value(), *environment.device, report));
  }
  report.figures.seconds_by_stage = clock.seconds();
  report.figures.labels_by_sequence = surveyed.value().statistics();
  report.figures.frames = job.streamFrames();
  report.figures.notes = notesOf(job);
  report.figures.peak_rss_bytes = peakResidentBytes();
  report.wall_s = progress.seconds() + report.figures.seconds_by_stage["validate"];
  FOURDVT_TRY(writeReportFiles(job, report));
  FOURDVT_TRY(
      platform::replaceFolder(job.resultFolder(), job.options.character_folder, job.workFolder() + "/previous"));
  platform::removeFolder(job.workFolder());
  return report.figures;
}

}  // namespace

Result<BakeReport> bake(const BakeOptions& given, const BakeEnvironment& environment) {
  BakeOptions options = given;
  while (options.character_folder.size() > 1 && options.character_folder.back() == '/')
    options.character_folder.pop_back();
  StageClock clock;
  auto job = [&] {
    StageClock::Span span(clock, "validate");
    return validate(options, environment);
  }();
  if (!job) {
    platform::removeIfEmpty(options.character_folder + ".work");
    return job.error();
  }
  auto result = runJob(job.value(), environment, clock);
  if (result) return result;
  Error error = result.error();
  const std::string work = job.value().workFolder();
  platform::removeFolder(job.value().resultFolder());
  platform::removeIfEmpty(work);
  if (error.id == ErrorId::Interrupted) return error;  // says it itself
  if (WorkFolder::holdsGops(work))
    error.message += "; finished GOPs are kept in " + work + " for --resume";
  else if (error.id != ErrorId::WriteFailed)  // with room to write, what the survey measured goes on
    platform::removeFolder(work);
  return error;
}

}  // namespace fourdvt::bake
