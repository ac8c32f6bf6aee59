// SPDX-License-Identifier: Apache-2.0
// plan: cuts a bake, a reconstruction or tracking into pieces for a job engine on many machines.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "base/watch.h"
#include "platform/files.h"
#include "reconstruct/run/pieces.h"
#include "tools/planned_commands.h"
#include "tools/terminal.h"
#include "track/run/pieces.h"

namespace fourdvt::tools {
namespace {

constexpr const char* kPlanUsage =
    "usage: fourdvt plan bake CAPTURE -o CHARACTER [options of `fourdvt bake`]\n"
    "       fourdvt plan reconstruct CAPTURE -o CAPTURE2 [options of `fourdvt reconstruct`]\n"
    "       fourdvt plan track SURFACES -o CAPTURE2 [options of `fourdvt track`]\n\n"
    "Cuts a command into pieces that many machines can compute, and writes the plan, with a Snakefile and profiles "
    "for\n"
    "this machine and for Slurm, into the job folder CHARACTER.work or CAPTURE2.work. What that folder has of the "
    "same\n"
    "capture and settings stays. Capture and job folder must have the same paths on all machines.\n\n"
    "Whatever all pieces need is made here, in one process: of a bake the refinement; of a reconstruction, which "
    "needs\n"
    "no GPU until its pieces run, the calibration and mattes that the capture lacks; of tracking the cropped "
    "pictures,\n"
    "the template and the order of the frames.\n";

// File of tools/cluster/, written into a job folder.
struct ClusterFile {
  const char* name;  // inside the job folder
  std::string_view text;
};
constexpr ClusterFile kClusterFiles[] = {
#include "tools/cluster_files.inc"
};

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

// Quotes a path for a shell.
std::string quoted(const std::string& path) {
  if (path.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+=:,@%") == path.npos)
    return path;
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

void printPlan(const std::string& job_folder, const jobs::Plan& plan, double seconds) {
  double work_s = 0, max_mb = 0;
  for (const jobs::Piece& piece : plan.pieces) {
    work_s += piece.seconds;
    max_mb = std::max(max_mb, piece.memory_mb);
  }
  note(
      "%s: %zu pieces of %u frames, planned in %.1f s; about %.0f min of work on two cores, at most %.1f GB a piece\n"
      "on this machine: snakemake --directory %s --snakefile %s --profile %s\n"
      "on a cluster:    the same with profiles/slurm",
      job_folder.c_str(), plan.pieces.size(), plan.frames, seconds, work_s / 60, max_mb / 1e3,
      quoted(job_folder).c_str(), quoted(job_folder + "/Snakefile").c_str(),
      quoted(job_folder + "/profiles/local").c_str());
}

// Writes the plan from `make`, and the files that run it, into the job folder.
template <class Make>
Result<int> planned(ProgressLine& line, const Make& make) {
  const Watch watch;
  FOURDVT_ASSIGN(const auto plan, make());
  line.end();
  const std::string job_folder = plan.result + ".work";
  FOURDVT_TRY(writeClusterFiles(job_folder));
  printPlan(job_folder, plan, watch.seconds());
  return kOk;
}

Result<int> planBakeCommand(int argc, char** argv) {
  bake::BakeOptions options;
  FOURDVT_ASSIGN(const auto code, readBakeCommand(argc, argv, options));
  if (code) return *code;
  FOURDVT_ASSIGN(const auto gpu, openGpu());
  ProgressLine line;
  const auto environment = bakeEnvironment(gpu, line);
  return planned(line, [&] { return bake::planBake(options, {argv, argv + argc}, environment); });
}

Result<int> planReconstructCommand(int argc, char** argv) {
  reconstruct::ReconstructOptions options;
  if (const auto code = readReconstructCommand(argc, argv, options)) return *code;
  ProgressLine line;
  const auto environment = reconstructEnvironment({}, line);
  return planned(line, [&] { return reconstruct::planReconstruct(options, {argv, argv + argc}, environment); });
}

Result<int> planTrackCommand(int argc, char** argv) {
  track::TrackOptions options;
  FOURDVT_ASSIGN(const auto code, readTrackCommand(argc, argv, options));
  if (code) return *code;
  ProgressLine line;
  const auto environment = trackEnvironment(line);
  return planned(line, [&] { return track::planTrack(options, {argv, argv + argc}, environment); });
}

struct PlannedCommand {
  const char* name;
  Result<int> (*plan)(int argc, char** argv);
};
constexpr PlannedCommand kPlannedCommands[] = {
    {"bake", planBakeCommand}, {"reconstruct", planReconstructCommand}, {"track", planTrackCommand}};

}  // namespace

Result<int> planCommand(int argc, char** argv) {
  const char* command = argc > 0 ? argv[0] : "";
  for (const PlannedCommand& known : kPlannedCommands)
    if (std::strcmp(command, known.name) == 0) return known.plan(argc - 1, argv + 1);
  const bool help = std::strcmp(command, "--help") == 0 || std::strcmp(command, "-h") == 0;
  if (!help) std::fprintf(stderr, "%s: plan needs a command line of bake, reconstruct or track\n", programName());
  std::fputs(kPlanUsage, help ? stdout : stderr);
  return help ? kOk : kUsage;
}

}  // namespace fourdvt::tools
