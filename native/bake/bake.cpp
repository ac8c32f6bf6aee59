// SPDX-License-Identifier: Apache-2.0
// Top level of a bake: validate → refine → warp → survey → every missing GOP, frame by frame → align → graph → room →
// assemble. From cameras: validate → refine → regions → colours → method → every missing GOP → room → assemble.
#include "bake/bake.h"

#include <algorithm>
#include <filesystem>

#include "bake/pieces.h"
#include "bake/run/bake_run.h"
#include "bake/run/character_files.h"
#include "bake/run/job.h"
#include "bake/run/renditions.h"
#include "bake/stages/stages.h"
#include "bake/stages/survey.h"
#include "base/hash.h"
#include "base/watch.h"
#include "capture/input_files.h"
#include "platform/files.h"
#include "platform/process.h"
#include "store/folder.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kJobFile = "/job.bin";

// Registers the amount of work of every stage with the progress, before the first stage begins.
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
  figures.peak_rss_bytes = platform::processUsage().peak_bytes;
  report.wall_s = run.progress.seconds() + figures.seconds_by_stage[infoOf(Stage::Validate).name];
}

Status bakeLayers(BakeRun& run, ReportInput& report) {
  FOURDVT_ASSIGN(const Survey survey, Survey::make(run));
  FOURDVT_ASSIGN(const uint32_t baked, bakeGops(run, survey));
  report.resumed = baked < run.job.streamFrames();
  report.figures.labels_by_sequence = survey.statistics();
  FOURDVT_TRY(alignClasses(run));
  Assembly parts;
  FOURDVT_ASSIGN(parts.graph, makeGraph(run));
  FOURDVT_ASSIGN(parts.room, makeRoom(run, survey.colourMaps()));
  return assemble(run, parts, report);
}

Status bakeCameras(BakeRun& run, ReportInput& report) {
  Assembly parts;
  FOURDVT_ASSIGN(parts.maps, calibrateColours(run));
  FOURDVT_ASSIGN(report.figures.method, chooseBakedMethod(run, parts.maps));
  FOURDVT_ASSIGN(const uint32_t baked, bakeGops(run, parts.maps));
  report.resumed = baked < run.job.streamFrames();
  FOURDVT_ASSIGN(parts.room, makeRoom(run, parts.maps));
  return assemble(run, parts, report);
}

// Completes the key of the job folder together with those of its survey files, so that both carry the build or
// neither does.
void settleJobKeys(Job& job, bool in_pieces) {
  settleKeys(job);
  const std::string settings = job.settings_key;
  job.settings_key = jobs::folderKey(settings, in_pieces,
                                     [&](const std::string& key) { return store::keyOf(job.workFolder()) == key; });
  for (auto& [sequence, key] : job.capture_keys) key += job.settings_key.substr(settings.size());
}

// Restarts work that another build planned: its results do not fit together with this build's.
void dropOtherBuilds(BakeOptions& options, const BakeEnvironment& environment) {
  const std::string folder = options.character_folder + ".work";
  if (!options.resume || !jobs::holdsPlanOfAnotherBuild(folder)) return;
  options.resume = false;
  if (environment.note) environment.note(folder + ": holds work of another build of fourdvt; all begins again");
}

// Completes the job with the stages that every piece depends on, and stores their results.
Status planJob(BakeRun& run, bool in_pieces) {
  Job& job = run.job;
  FOURDVT_TRY(refineJob(run));
  FOURDVT_TRY(job.fromCameras() ? planCameraStreams(run) : planStreams(run));
  settleJobKeys(job, in_pieces);
  const auto restarts = [&] {
    if (run.environment.note)
      run.environment.note(
          job.workFolder() +
          ": holds work of other settings, of another capture or of another version; all begins again");
  };
  FOURDVT_ASSIGN(run.work, WorkFolder::open(job.workFolder(), job.settings_key, job.options.resume, restarts));
  return keepRefinement(run);
}

// Computes missing pieces, and publishes the character.
Result<BakeReport> finishJob(BakeRun& run) {
  const Job& job = run.job;
  ReportInput report;
  FOURDVT_TRY(job.fromCameras() ? bakeCameras(run, report) : bakeLayers(run, report));
  addFigures(run, report);
  FOURDVT_TRY(writeReportFiles(job, report));
  FOURDVT_TRY(publish(job.resultFolder(), job.options.character_folder));
  if (const Status published = publishReport(job.reportFolder(), reportFolderOf(job.options.character_folder));
      !published.ok())
    return Error{published.error().id,
                 "the character is published, but its report is not: " + published.error().message};
  return report.figures;
}

Result<BakeReport> runStages(BakeRun& run) {
  expectWork(run);
  FOURDVT_TRY(planJob(run, false));
  auto report = finishJob(run);
  if (report) store::removeFolder(run.job.workFolder());
  return report;
}

// Cleans up after an unfinished bake: finished GOPs and the survey's measurements stay, partial results are removed.
Error cleanedUp(Error error, const Job& job) {
  const std::string work = job.workFolder();
  platform::removeFolder(job.resultFolder());
  platform::removeFolder(job.reportFolder());
  platform::removeIfEmpty(work);
  if (error.id == ErrorId::Interrupted) return error;                       // the message names the files that stay
  if (platform::fileBytes(work + "/" + jobs::kPlanFile) > 0) return error;  // pieces of a plan can be resumed
  if (WorkFolder::holdsGops(work))
    error.message += "; finished GOPs are kept in " + work + " for --resume";
  else if (error.id != ErrorId::WriteFailed)  // after a failed write the survey's measurements stay for the next run
    store::removeFolder(work);
  return error;
}

BakeOptions withoutTrailingSlash(BakeOptions options) {
  std::string& path = options.character_folder;
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return options;
}

// A resumed run with its plan, and its pieces in the plan's order.
struct OpenJob {
  std::vector<BakePiece> pieces;
  std::unique_ptr<BakeRun> run;
};

Error planAgain(const std::string& path, const char* what) {
  return {ErrorId::InvalidArgument, path + ": " + what + "; run `fourdvt plan` again"};
}

// Rejects a job that differs from the plan's, and a folder that has been moved.
Status checkJob(const std::string& job_folder, const Job& job, const std::vector<BakePiece>& pieces,
                const jobs::Plan& plan) {
  std::error_code ignored;
  if (!std::filesystem::equivalent(job_folder, job.workFolder(), ignored))
    return planAgain(job_folder, ("planned as " + job.workFolder() + ", and moved since").c_str());
  jobs::Plan now = plan;
  now.pieces.clear();
  for (const BakePiece& piece : pieces) now.pieces.push_back(piece.piece);
  FOURDVT_TRY(jobs::settleHashes(job.settings_key, now));
  if (now.pieces.back().hash == plan.pieces.back().hash) return {};
  return planAgain(job_folder + kJobFile, "belongs to another plan than plan.json");
}

Result<OpenJob> openJob(const std::string& job_folder, const jobs::Plan& plan, const BakeEnvironment& environment) {
  OpenJob out;
  auto loaded = loadJob(job_folder + kJobFile);
  if (!loaded) return planAgain(job_folder + kJobFile, "is missing or damaged");
  Job job = loaded.take();
  out.pieces = bakePieces(job);
  FOURDVT_TRY(checkJob(job_folder, job, out.pieces, plan));
  out.run = std::make_unique<BakeRun>(std::move(job), environment);
  FOURDVT_ASSIGN(out.run->work, WorkFolder::join(job_folder, out.run->job.settings_key));
  return out;
}

}  // namespace

Result<jobs::Plan> planBake(const BakeOptions& given, std::vector<std::string> arguments,
                            const BakeEnvironment& environment) {
  BakeOptions options = withoutTrailingSlash(given);
  options.resume = true;
  std::error_code failed;  // pieces run in other folders
  if (const auto path = std::filesystem::absolute(options.character_folder, failed); !failed)
    options.character_folder = path.lexically_normal().string();
  dropOtherBuilds(options, environment);
  FOURDVT_ASSIGN(auto job, validate(options, environment));
  BakeRun run(std::move(job), environment);
  FOURDVT_TRY(planJob(run, true));
  const std::string job_folder = run.job.workFolder();
  jobs::Plan plan{.command = "bake",
                  .arguments = std::move(arguments),
                  .capture = run.job.capture.folder,
                  .result = run.job.options.character_folder,
                  .frames = run.job.total_frames,
                  .capture_s = run.job.total_frames / run.job.capture.fps};
  const auto pieces = bakePieces(run.job);
  for (const BakePiece& piece : pieces) plan.pieces.push_back(piece.piece);
  FOURDVT_TRY(jobs::settleHashes(run.job.settings_key, plan));
  FOURDVT_ASSIGN(const auto lost, lostPieces(run, pieces));
  jobs::dropRecords(job_folder, plan, [&](size_t piece) { return lost[piece]; });
  FOURDVT_TRY(jobs::indexVideos(job_folder, capture::videoFiles(run.job.capture), environment.stop));
  FOURDVT_TRY(saveJob(job_folder + kJobFile, run.job));
  FOURDVT_TRY(jobs::writePlan(job_folder, plan));
  return plan;
}

Status bakePiece(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads,
                 const BakeEnvironment& environment) {
  FOURDVT_ASSIGN(const OpenJob open, openJob(job_folder, plan, environment));
  open.run->job.options.jobs = threads;
  return runPiece(*open.run, open.pieces[size_t(&piece - plan.pieces.data())]);
}

Result<BakeReport> finishBake(const std::string& job_folder, const jobs::Plan& plan,
                              const BakeEnvironment& environment) {
  FOURDVT_ASSIGN(const OpenJob open, openJob(job_folder, plan, environment));
  Job& job = open.run->job;
  job.writer = "." + environment.writer;
  FOURDVT_TRY(checkPieceInputs(*open.run, open.pieces.back()));
  if (!loadRefinementPictures(job)) return planAgain(job.refinement_path, "is missing or damaged");
  expectWork(*open.run);
  auto report = finishJob(*open.run);
  if (!report) {
    platform::removeFolder(job.resultFolder());
    platform::removeFolder(job.reportFolder());
  }
  return report;
}

Result<BakeReport> bake(const BakeOptions& given, const BakeEnvironment& environment) {
  BakeOptions options = withoutTrailingSlash(given);
  dropOtherBuilds(options, environment);
  const Watch watch;
  auto job = validate(options, environment);
  if (!job) {
    platform::removeIfEmpty(options.character_folder + ".work");
    return job.error();
  }
  BakeRun run(job.take(), environment);
  run.clock.add(Stage::Validate, watch.seconds());
  auto report = runStages(run);
  if (report) return report;
  return cleanedUp(report.error(), run.job);
}

}  // namespace fourdvt::bake
