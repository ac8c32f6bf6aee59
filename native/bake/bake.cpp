// SPDX-License-Identifier: Apache-2.0
// The recipe: validate → refine → warp → survey → every missing GOP, frame by frame → align → graph → room →
// assemble. From cameras: validate → refine → regions → colours → method → every missing GOP →
// room → assemble.
#include "bake/bake.h"

#include <algorithm>

#include "bake/run/bake_run.h"
#include "bake/run/publish.h"
#include "bake/run/renditions.h"
#include "bake/stages/align_stage.h"
#include "bake/stages/assemble.h"
#include "bake/stages/camera_assembly.h"
#include "bake/stages/camera_colours.h"
#include "bake/stages/camera_gops.h"
#include "bake/stages/camera_plan.h"
#include "bake/stages/gop_stage.h"
#include "bake/stages/graph_stage.h"
#include "bake/stages/method_stage.h"
#include "bake/stages/refine_stage.h"
#include "bake/stages/room_stage.h"
#include "bake/stages/stream_plan.h"
#include "bake/stages/survey.h"
#include "bake/stages/validate.h"
#include "platform/folders.h"

namespace fourdvt::bake {
namespace {

// Tells the progress how much work every stage has to do, before the first of them begins.
void expectWork(BakeRun& run) {
  const Job& job = run.job;
  uint32_t phases = 0, member_phases = 0;
  for (const capture::CaptureClass* c : bakedClasses(job)) {
    const uint32_t frames = expectedPhases(job, *c);
    phases += frames;
    member_phases += frames * static_cast<uint32_t>(c->members.size());
  }
  run.progress.frames_total = job.total_frames + phases;
  const auto expect = [&](Stage stage, uint32_t units) { run.progress.expect(infoOf(stage).work_s * units); };
  if (job.options.refine.any()) expect(Stage::Refine, job.total_frames);
  if (job.capture.room) expect(Stage::Room, 1);
  if (job.fromCameras()) {
    expect(Stage::Regions, job.total_frames);
    if (job.options.cameras.method.empty() && job.cameras.size() >= 3)
      expect(Stage::Method, std::min(kTrialFrames, job.total_frames));
    run.progress.expect(encodeWork(job.options) * job.total_frames);
    return;
  }
  expect(Stage::Warp, member_phases);
  expect(Stage::Visibility, job.total_frames);
  run.progress.expect(encodeWork(job.options) * (job.total_frames + member_phases));
  expect(Stage::Graph, run.progress.frames_total);
  if (job.options.classes.align) expect(Stage::Align, member_phases - phases);
}

// Drops duplicates: classes repeat their members' notes.
std::vector<std::string> notesOf(const Job& job) {
  std::vector<std::string> notes = job.notes;
  for (const StreamPlan& plan : job.streams)
    for (const std::string& note : plan.motion.notes)
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  return notes;
}

void addFigures(const BakeRun& run, ReportInput& report) {
  BakeReport& figures = report.figures;
  figures.seconds_by_stage = run.clock.seconds();
  figures.refinement = run.job.refinement;
  figures.frames = run.job.streamFrames();
  figures.notes = notesOf(run.job);
  figures.peak_rss_bytes = peakResidentBytes();
  report.wall_s = run.progress.seconds() + figures.seconds_by_stage[infoOf(Stage::Validate).name];
}

Status bakeLayers(BakeRun& run, ReportInput& report) {
  FOURDVT_ASSIGN(const Survey survey, Survey::make(run));
  GopStage gops(run, survey);
  FOURDVT_TRY(gops.run());
  FOURDVT_TRY(alignClasses(run));
  FOURDVT_ASSIGN(const auto graph, makeGraph(run));
  report.resumed = gops.framesBaked() < run.job.streamFrames();
  report.figures.labels_by_sequence = survey.statistics();
  FOURDVT_ASSIGN(const auto room, makeRoom(run, survey.colourMaps()));
  return assemble(run, graph, room, report);
}

Status bakeCameras(BakeRun& run, ReportInput& report) {
  FOURDVT_ASSIGN(const auto maps, calibrateColours(run));
  FOURDVT_ASSIGN(report.figures.method, chooseBakedMethod(run, maps));
  CameraGops gops(run, maps);
  FOURDVT_TRY(gops.run());
  report.resumed = gops.framesBaked() < run.job.streamFrames();
  FOURDVT_ASSIGN(const auto room, makeRoom(run, maps));
  return assembleCameras(run, maps, room, report);
}

Result<BakeReport> runStages(BakeRun& run) {
  const Job& job = run.job;
  expectWork(run);
  FOURDVT_TRY(refineJob(run));
  FOURDVT_TRY(job.fromCameras() ? planCameraStreams(run) : planStreams(run));
  FOURDVT_ASSIGN(run.work, WorkFolder::open(job.workFolder(), settingsKey(job), job.options.resume));
  FOURDVT_TRY(keepRefinement(run));
  ReportInput report;
  FOURDVT_TRY(job.fromCameras() ? bakeCameras(run, report) : bakeLayers(run, report));
  addFigures(run, report);
  FOURDVT_TRY(writeReportFiles(job, report));
  FOURDVT_TRY(publish(job.resultFolder(), job.options.character_folder));
  if (const Status published = publishReport(job.reportFolder(), reportFolderOf(job.options.character_folder));
      !published.ok())
    return Error{published.error().id,
                 "the character is published, but its report is not: " + published.error().message};
  platform::removeFolder(job.workFolder());
  return report.figures;
}

// Tidies up after an unfinished bake: finished GOPs and what the survey measured stay, half a result never does.
Error cleanedUp(Error error, const Job& job) {
  const std::string work = job.workFolder();
  platform::removeFolder(job.resultFolder());
  platform::removeFolder(job.reportFolder());
  platform::removeIfEmpty(work);
  if (error.id == ErrorId::Interrupted) return error;  // its message says what stays
  if (WorkFolder::holdsGops(work))
    error.message += "; finished GOPs are kept in " + work + " for --resume";
  else if (error.id != ErrorId::WriteFailed)  // after a failed write, what the survey measured stays for the next run
    platform::removeFolder(work);
  return error;
}

std::string withoutTrailingSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

}  // namespace

Result<BakeReport> bake(const BakeOptions& given, const BakeEnvironment& environment) {
  BakeOptions options = given;
  options.character_folder = withoutTrailingSlash(given.character_folder);
  const auto started = std::chrono::steady_clock::now();
  auto job = validate(options, environment);
  if (!job) {
    platform::removeIfEmpty(options.character_folder + ".work");
    return job.error();
  }
  BakeRun run(job.take(), environment);
  run.clock.add(Stage::Validate, std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
  auto report = runStages(run);
  if (report) return report;
  return cleanedUp(report.error(), run.job);
}

}  // namespace fourdvt::bake
