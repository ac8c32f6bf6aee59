// SPDX-License-Identifier: Apache-2.0
// plan, piece, finish, job: a bake or a reconstruction in pieces, for an engine that runs them on many machines.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "jobs/records.h"
#include "jobs/report.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "tools/bake_arguments.h"
#include "tools/cluster_files.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

constexpr const char* kPlanUsage =
    "usage: fourdvt plan bake CAPTURE -o CHARACTER [options of `fourdvt bake`]\n\n"
    "Cuts a bake into pieces that many machines can compute, and writes the plan, with a Snakefile and profiles for "
    "this\n"
    "machine and for Slurm, into the job folder CHARACTER.work. What that folder has of the same capture and settings\n"
    "stays. Capture and job folder must have the same paths on all machines.\n";

std::string withoutSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

Status writeClusterFiles(const std::string& job_folder) {
  for (const ClusterFile& file : kClusterFiles) {
    const std::filesystem::path path = job_folder + "/" + file.name;
    FOURDVT_TRY(platform::makeFolder(path.parent_path().string()));
    FOURDVT_TRY(platform::writeFileAtomic(path.string(), std::string(file.text)));
    std::error_code ignored;
    if (path.extension() == ".sh")
      std::filesystem::permissions(path, std::filesystem::perms::owner_exec | std::filesystem::perms::group_exec,
                                   std::filesystem::perm_options::add, ignored);
  }
  return {};
}

void printPlan(const std::string& job_folder, const jobs::Plan& plan, double seconds) {
  double work_s = 0, most_mb = 0;
  for (const jobs::Piece& piece : plan.pieces) {
    work_s += piece.seconds;
    most_mb = std::max(most_mb, piece.memory_mb);
  }
  std::printf(
      "%s: %zu pieces of %u frames, planned in %.1f s; about %.0f min of work on two cores, at most %.1f GB a piece\n"
      "on this machine: snakemake --directory %s --snakefile %s/Snakefile --profile %s/profiles/local\n"
      "on a cluster:    the same with profiles/slurm\n",
      job_folder.c_str(), plan.pieces.size(), plan.frames, seconds, work_s / 60, most_mb / 1e3, job_folder.c_str(),
      job_folder.c_str(), job_folder.c_str());
}

int planBakeCommand(int argc, char** argv) {
  const auto [options, exit_code] = readBakeCommand(argc, argv);
  if (exit_code) return *exit_code;
  const std::atomic<bool>* stop = listenForStop();
  auto gpu = openGpu();
  if (!gpu.ok()) return fail(gpu.error());
  ProgressLine line;
  bake::BakeEnvironment environment = bakeEnvironment(gpu.value(), line);
  environment.stop = stop;
  const auto start = std::chrono::steady_clock::now();
  const auto plan = bake::planBake(options, {argv, argv + argc}, environment);
  line.end();
  if (!plan.ok()) return fail(plan.error());
  const std::string job_folder = withoutSlash(options.character_folder) + ".work";
  if (const Status written = writeClusterFiles(job_folder); !written.ok()) return fail(written.error());
  printPlan(job_folder, plan.value(), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return kOk;
}

const CommandHelp& pieceHelp() {
  static const CommandHelp text{"piece JOB ID [options]",
                                "Computes one piece of a plan; Snakemake calls it. JOB is the folder that `fourdvt "
                                "plan` has made, and its plan.json "
                                "lists the pieces. A piece that is done already is left as it is.",
                                {{"--threads", "N", "worker threads, 1 to 1024 (default 2)"}},
                                nullptr,
                                "ID"};
  return text;
}

const CommandHelp& finishHelp() {
  static const CommandHelp text{"finish JOB",
                                "Writes the result of a plan whose pieces are done, and the job's report. JOB stays; "
                                "delete it when you do not want to plan on from it.",
                                {}};
  return text;
}

const CommandHelp& jobHelp() {
  static const CommandHelp text{"job JOB",
                                "Prints how far a job is, and writes the report over its pieces: their seconds and "
                                "memory, the slowest, those that were started again (JOB/job.html).",
                                {}};
  return text;
}

// Counts the attempt, does the work, writes the record.
template <class Work>
Status recorded(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, Work work) {
  if (jobs::isDone(job_folder, piece)) return {};
  FOURDVT_TRY(jobs::checkTool(job_folder, plan));
  FOURDVT_TRY(jobs::checkNeeds(job_folder, plan, piece));
  FOURDVT_ASSIGN(auto attempt, jobs::Attempt::begin(job_folder, piece));
  FOURDVT_TRY(work());
  FOURDVT_ASSIGN(const auto record, attempt.finish());
  if (record.peak_mb > piece.memory_mb)
    std::fprintf(stderr, "%s: piece %s took %.0f MB, more than the %.0f MB that the plan allows\n", programName(),
                 piece.id.c_str(), record.peak_mb, piece.memory_mb);
  return {};
}

Status computePiece(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads) {
  return recorded(job_folder, plan, piece, [&]() -> Status {
    FOURDVT_ASSIGN(auto gpu, openGpu());
    ProgressLine line;
    bake::BakeEnvironment environment = bakeEnvironment(gpu, line);
    environment.writer = "." + platform::ownSuffix();
    environment.stop = listenForStop();
    const Status done = bake::bakePiece(job_folder, piece.id, threads, environment);
    line.end();
    return done;
  });
}

Status finishJob(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece) {
  FOURDVT_TRY(recorded(job_folder, plan, piece, [&]() -> Status {
    FOURDVT_ASSIGN(auto gpu, openGpu());
    ProgressLine line;
    bake::BakeEnvironment environment = bakeEnvironment(gpu, line);
    environment.stop = listenForStop();
    const auto start = std::chrono::steady_clock::now();
    const auto report = bake::finishBake(job_folder, environment);
    line.end();
    if (!report) return report.error();
    printBakeSummary(plan.result, report.value(),
                     std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return {};
  }));
  FOURDVT_TRY(jobs::writeReport(job_folder, plan, jobs::readProgress(job_folder, plan)));
  std::printf("cost of the pieces: %s/%s\n", job_folder.c_str(), jobs::kReportHtml);
  return {};
}

}  // namespace

int planCommand(int argc, char** argv) {
  const char* command = argc > 0 ? argv[0] : "";
  if (std::strcmp(command, "bake") == 0) return planBakeCommand(argc - 1, argv + 1);
  const bool help = std::strcmp(command, "--help") == 0 || std::strcmp(command, "-h") == 0;
  if (!help) std::fprintf(stderr, "%s: plan needs a command line of bake\n", programName());
  std::fputs(kPlanUsage, help ? stdout : stderr);
  return help ? kOk : kUsage;
}

int pieceCommand(int argc, char** argv) {
  Args args(pieceHelp(), argc, argv);
  const std::string job_folder = withoutSlash(args.positional()), id = args.second();
  const int threads = args.integer("--threads", 2, 1, 1024);
  if (const auto code = helpOrProblem(pieceHelp(), args)) return *code;
  const auto plan = jobs::readPlan(job_folder);
  if (!plan.ok()) return fail(plan.error());
  const jobs::Piece* piece = plan.value().find(id);
  if (!piece)
    return fail({ErrorId::InvalidArgument, job_folder + ": has no piece \"" + id + "\"; plan.json lists them"});
  const Status done = piece->kind == jobs::kFinish ? finishJob(job_folder, plan.value(), *piece)
                                                   : computePiece(job_folder, plan.value(), *piece, threads);
  return done.ok() ? kOk : fail(done.error());
}

int finishCommand(int argc, char** argv) {
  Args args(finishHelp(), argc, argv);
  const std::string job_folder = withoutSlash(args.positional());
  if (const auto code = helpOrProblem(finishHelp(), args)) return *code;
  const auto plan = jobs::readPlan(job_folder);
  if (!plan.ok()) return fail(plan.error());
  const Status done = finishJob(job_folder, plan.value(), plan.value().pieces.back());
  return done.ok() ? kOk : fail(done.error());
}

int jobCommand(int argc, char** argv) {
  Args args(jobHelp(), argc, argv);
  const std::string job_folder = withoutSlash(args.positional());
  if (const auto code = helpOrProblem(jobHelp(), args)) return *code;
  const auto plan = jobs::readPlan(job_folder);
  if (!plan.ok()) return fail(plan.error());
  const jobs::Progress progress = jobs::readProgress(job_folder, plan.value());
  if (const Status written = jobs::writeReport(job_folder, plan.value(), progress); !written.ok())
    return fail(written.error());
  std::printf("%s: %s\nreport: %s/%s\n", job_folder.c_str(), jobs::progressLine(plan.value(), progress).c_str(),
              job_folder.c_str(), jobs::kReportHtml);
  return kOk;
}

}  // namespace fourdvt::tools
