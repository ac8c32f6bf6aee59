// SPDX-License-Identifier: Apache-2.0
// Plan of a job: a dependency graph of pieces in topological order, stored in the job folder as plan.json, which
// Snakemake reads too. The job folder holds:
//   plan.json   the plan              done/   one record per finished piece (records.h)
//   attempts/   one file per start    logs/   output of the pieces
// Independent of what a piece computes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::jobs {

inline constexpr const char* kPlanFile = "plan.json";
inline constexpr const char* kFinish = "finish";  // kind and id of the last piece

// Identity of the running program (tool.cpp).
struct Tool {
  std::string version;
  // Hash of the program's file and of the shared libraries loaded at start, including preloaded ones (build-ids, or
  // else names and sizes), since codecs and mathematics reside there. Graphics drivers load later and are excluded.
  std::string build;
  std::string program;  // absolute path
};

const Tool& thisTool();

// Key of a job folder's settings. Contains the build if the folder has work with such a key, or if a plan begins
// (`in_pieces`), since machines with another build may compute pieces. Otherwise the settings alone: a plan resumes the
// work of a single process and vice versa. `holds` returns true if the folder has work with a key.
std::string folderKey(const std::string& settings, bool in_pieces,
                      const std::function<bool(const std::string& key)>& holds);

struct Piece {
  std::string id;    // letters, digits, "_", "-" and "."
  std::string kind;  // category in progress reports, such as "gop"
  std::vector<std::string> needs;
  double seconds = 0;        // estimate, on two cores of a present desktop
  double memory_mb = 0;      // upper bound of resident memory
  uint64_t inputs = 0;       // hash of its inputs, without results of pieces in `needs`
  uint64_t hash = 0;         // hash of everything that the piece's output depends on, set by settleHashes
  std::string done() const;  // path of its record in the job folder
  void addInput(uint64_t digest);
  void setCost(double estimated_s, double max_mb);  // stores both rounded
};

struct Plan {
  Tool tool = thisTool();
  std::string command;                 // "bake", "reconstruct" or "track"
  std::vector<std::string> arguments;  // the command's arguments
  std::string capture, result;         // absolute paths of folders
  uint32_t frames = 0;
  double capture_s = 0;  // duration of the captured footage
  std::vector<Piece> pieces;

  const Piece* find(const std::string& id) const;
};

// Checks that sequence names are valid in ids of pieces. `command`: the remedy, without pieces. Errors: CaptureJson.
Status checkSequenceNames(const std::vector<std::string>& sequences, const std::string& capture_folder,
                          const std::string& command);

// Sets the hashes of all pieces from their inputs, the settings and the build. Errors: Internal (a piece precedes one
// that it needs).
Status settleHashes(const std::string& settings_key, Plan& plan);

std::string planJson(const Plan& plan);
// Writes plan.json atomically, and the folders that pieces write into. Errors: WriteFailed.
Status writePlan(const std::string& job_folder, const Plan& plan);
// Removes the records of pieces whose results are lost, and that of the last piece, whose result may have to be moved
// into place again.
void dropRecords(const std::string& job_folder, const Plan& plan, const std::function<bool(size_t piece)>& is_lost);
// Lists the time stamps of a capture's videos once while planning: without an index, each piece that begins deep inside
// a video would read all of it. Blocks until all are listed. Errors: those of platform::indexVideo; WriteFailed;
// Interrupted once `stop` (may be null) is set.
Status indexVideos(const std::string& job_folder, const std::vector<std::string>& paths, const std::atomic<bool>* stop);
// Folder of the time stamps, for platform::openIndexedVideo.
std::string videoIndexFolder(const std::string& job_folder);
// Error of a piece whose input files differ from those of the plan.
Error changedSincePlan(const std::string& what);
// Errors: FileMissing, FileUnreadable.
Result<Plan> readPlan(const std::string& job_folder);
// Rejects a plan made by another build of the program. Errors: InvalidArgument.
Status checkTool(const std::string& job_folder, const Plan& plan);
// True if the folder holds a plan made by another build of the program.
bool holdsPlanOfAnotherBuild(const std::string& job_folder);

}  // namespace fourdvt::jobs
