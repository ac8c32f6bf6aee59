// SPDX-License-Identifier: Apache-2.0
// piece, finish, job: runs a piece of a plan, joins the pieces' results, reports progress.
#include <cstdio>

#include "base/watch.h"
#include "jobs/records.h"
#include "platform/process.h"
#include "reconstruct/run/pieces.h"
#include "tools/planned_commands.h"
#include "tools/terminal.h"
#include "track/run/pieces.h"

namespace fourdvt::tools {
namespace {

std::string withoutSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

// Counts the attempt, runs the work, writes the record.
template <class Work>
Status recorded(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, Work work) {
  if (jobs::isDone(job_folder, piece)) return {};
  FOURDVT_TRY(jobs::checkTool(job_folder, plan));
  FOURDVT_TRY(jobs::checkNeeds(job_folder, plan, piece));
  FOURDVT_ASSIGN(auto attempt, jobs::Attempt::begin(job_folder, piece));
  FOURDVT_TRY(work());
  FOURDVT_ASSIGN(const auto record, attempt.finish());
  if (record.peak_mb > piece.memory_mb)
    warn("piece %s took %.0f MB, more than the %.0f MB that the plan allows", piece.id.c_str(), record.peak_mb,
         piece.memory_mb);
  return {};
}

// Command environment of one process among several: with the job's cached time stamps of videos.
bake::BakeEnvironment inJob(const std::string& job_folder, bake::BakeEnvironment environment) {
  environment.writer = platform::ownSuffix();
  environment.open_video = videoOpener(jobs::videoIndexFolder(job_folder));
  return environment;
}

reconstruct::ReconstructEnvironment inJob(const std::string& job_folder,
                                          reconstruct::ReconstructEnvironment environment) {
  environment.open_video = videoOpener(jobs::videoIndexFolder(job_folder));
  return environment;
}

Status bakePieceOf(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads,
                   ProgressLine& line) {
  FOURDVT_ASSIGN(const auto gpu, openGpu());
  return bake::bakePiece(job_folder, plan, piece, threads, inJob(job_folder, bakeEnvironment(gpu, line)));
}

Status reconstructPieceOf(const std::string& job_folder, const jobs::Plan&, const jobs::Piece& piece, int threads,
                          ProgressLine& line) {
  GpuSession gpu;
  FOURDVT_ASSIGN(const bool needs_gpu, reconstruct::piecesNeedDevice(job_folder));
  if (needs_gpu) {
    FOURDVT_ASSIGN(gpu, openGpu());
  }
  return reconstruct::reconstructPiece(job_folder, piece, threads,
                                       inJob(job_folder, reconstructEnvironment(gpu, line)));
}

Status trackPieceOf(const std::string& job_folder, const jobs::Plan&, const jobs::Piece& piece, int threads,
                    ProgressLine& line) {
  return track::trackPiece(job_folder, piece, threads, trackEnvironment(line));
}

Status finishBakeOf(const std::string& job_folder, const jobs::Plan& plan) {
  FOURDVT_ASSIGN(const auto gpu, openGpu());
  ProgressLine line;
  const bake::BakeEnvironment environment = inJob(job_folder, bakeEnvironment(gpu, line));
  const Watch watch;
  FOURDVT_ASSIGN(const auto report, bake::finishBake(job_folder, plan, environment));
  line.end();
  printBakeSummary(plan.result, report, watch.seconds());
  return {};
}

Status finishReconstructOf(const std::string& job_folder, const jobs::Plan& plan) {
  ProgressLine line;
  FOURDVT_ASSIGN(const auto summary,
                 reconstruct::finishReconstruct(job_folder, inJob(job_folder, reconstructEnvironment({}, line))));
  line.end();
  printReconstructSummary(plan.result, summary);
  return {};
}

Status finishTrackOf(const std::string& job_folder, const jobs::Plan& plan) {
  ProgressLine line;
  FOURDVT_ASSIGN(const auto summary, track::finishTrack(job_folder, trackEnvironment(line)));
  line.end();
  printTrackSummary(plan.result, summary);
  return {};
}

// Functions of a command that runs in pieces.
struct CommandInPieces {
  const char* name;  // in the plan
  Status (*compute)(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads,
                    ProgressLine& line);
  Status (*finish)(const std::string& job_folder, const jobs::Plan& plan);
};
constexpr CommandInPieces kCommandsInPieces[] = {{"bake", bakePieceOf, finishBakeOf},
                                                 {"reconstruct", reconstructPieceOf, finishReconstructOf},
                                                 {"track", trackPieceOf, finishTrackOf}};

Result<const CommandInPieces*> commandOf(const std::string& job_folder, const jobs::Plan& plan) {
  for (const CommandInPieces& command : kCommandsInPieces)
    if (plan.command == command.name) return &command;
  return Error{ErrorId::FileUnreadable, job_folder + "/" + jobs::kPlanFile + ": has the command \"" + plan.command +
                                            "\", which does not run in pieces; run `fourdvt plan` again"};
}

Status computePiece(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads) {
  FOURDVT_ASSIGN(const auto* command, commandOf(job_folder, plan));
  return recorded(job_folder, plan, piece, [&] {
    ProgressLine line;
    const Status done = command->compute(job_folder, plan, piece, threads, line);
    line.end();
    return done;
  });
}

Status finishJob(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece) {
  FOURDVT_ASSIGN(const auto* command, commandOf(job_folder, plan));
  FOURDVT_TRY(recorded(job_folder, plan, piece, [&] { return command->finish(job_folder, plan); }));
  FOURDVT_TRY(jobs::writeReport(job_folder, plan, jobs::readProgress(job_folder, plan)));
  note("cost of the pieces: %s/%s", job_folder.c_str(), jobs::kReportHtml);
  return {};
}

}  // namespace

Result<int> pieceCommand(int argc, char** argv) {
  std::string job_folder, id;
  int threads = 2;
  const Args args({"piece JOB ID [options]",
                   "Computes one piece of a plan; Snakemake calls it. JOB is the folder that `fourdvt plan` has made, "
                   "and its plan.json lists the pieces. A piece that is done already is left as it is.",
                   {&job_folder, &id},
                   {{"--threads N", number(threads, 1, 1024), "worker threads, 1 to 1024 (default 2)"}}},
                  argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  job_folder = withoutSlash(job_folder);
  FOURDVT_ASSIGN(const auto plan, jobs::readPlan(job_folder));
  const jobs::Piece* piece = plan.find(id);
  if (!piece)
    return Error{ErrorId::InvalidArgument, job_folder + ": has no piece \"" + id + "\"; plan.json lists them"};
  FOURDVT_TRY(piece->kind == jobs::kFinish ? finishJob(job_folder, plan, *piece)
                                           : computePiece(job_folder, plan, *piece, threads));
  return kOk;
}

Result<int> finishCommand(int argc, char** argv) {
  std::string job_folder;
  const Args args({"finish JOB",
                   "Writes the result of a plan whose pieces are done, and the job's report. JOB stays; delete it when "
                   "you do not want to plan on from it.",
                   {&job_folder},
                   {}},
                  argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  job_folder = withoutSlash(job_folder);
  FOURDVT_ASSIGN(const auto plan, jobs::readPlan(job_folder));
  FOURDVT_TRY(finishJob(job_folder, plan, plan.pieces.back()));
  return kOk;
}

Result<int> jobCommand(int argc, char** argv) {
  std::string job_folder;
  const Args args({"job JOB",
                   "Prints how far a job is, and writes the report over its pieces: their seconds and memory, the "
                   "slowest, those that were started again (JOB/job.html).",
                   {&job_folder},
                   {}},
                  argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  job_folder = withoutSlash(job_folder);
  FOURDVT_ASSIGN(const auto plan, jobs::readPlan(job_folder));
  const jobs::Progress progress = jobs::readProgress(job_folder, plan);
  FOURDVT_TRY(jobs::writeReport(job_folder, plan, progress));
  std::printf("%s: %s\nreport: %s/%s\n", job_folder.c_str(), jobs::progressLine(plan, progress).c_str(),
              job_folder.c_str(), jobs::kReportHtml);
  return kOk;
}

}  // namespace fourdvt::tools
