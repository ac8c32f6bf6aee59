// SPDX-License-Identifier: Apache-2.0
// The plan of a job: its pieces as a graph, in an order in which every piece comes after those that it needs. A job
// folder holds it as plan.json, which Snakemake reads too:
//   plan.json   the plan            done/       a record of every finished piece (records.h)
//   attempts/   one file a start    logs/       what pieces printed
// Does NOT know what a piece computes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "jobs/tool.h"

namespace fourdvt::jobs {

inline constexpr const char* kPlanFile = "plan.json";
inline constexpr const char* kFinish = "finish";  // kind and id of the last piece

struct Piece {
  std::string id;    // letters, digits, "_", "-" and "."
  std::string kind;  // what it is counted under, such as "gop"
  std::vector<std::string> needs;
  double seconds = 0;        // estimate, on two cores of a present desktop
  double memory_mb = 0;      // bound on its resident memory
  uint64_t inputs = 0;       // hash of what it reads besides what the pieces that it needs have made
  uint64_t hash = 0;         // of all that its output depends on; settleHashes sets it
  std::string done() const;  // path of its record, in the job folder
  void addInput(uint64_t digest);
  void setCost(double estimated_s, double most_mb);  // rounded
};

struct Plan {
  Tool tool = thisTool();
  std::string command;                 // "bake" or "reconstruct"
  std::vector<std::string> arguments;  // of that command
  std::string capture, result;         // folders, absolute
  uint32_t frames = 0;
  double capture_s = 0;  // duration of what was filmed
  std::vector<Piece> pieces;

  const Piece* find(const std::string& id) const;
};

// Sets the pieces' hashes: all pieces depend on the settings and on the build. Errors: Internal (a piece before one
// that it needs).
Status settleHashes(const std::string& settings_key, Plan& plan);

std::string planJson(const Plan& plan);
// Writes it atomically, with the folders that pieces write into. Errors: WriteFailed.
Status writePlan(const std::string& job_folder, const Plan& plan);
// Removes the records of pieces whose results are lost, and that of the last piece, whose result may have to be put
// into place again.
void dropRecords(const std::string& job_folder, const Plan& plan, const std::function<bool(size_t piece)>& is_lost);
// Time stamps of a capture's videos, listed once while planning: pieces that begin far inside a video without an index
// would each read all of it. Returns when all are listed. Errors: those of platform::indexVideo; WriteFailed;
// Interrupted once `stop`, if there is one, is set.
Status indexVideos(const std::string& job_folder, const std::vector<std::string>& paths, const std::atomic<bool>* stop);
// Their folder, for platform::openIndexedVideo.
std::string videoIndexFolder(const std::string& job_folder);
// Error of a piece whose files are not those of the plan.
Error changedSincePlan(const std::string& what);
// Errors: FileMissing, FileUnreadable.
Result<Plan> readPlan(const std::string& job_folder);
// Refuses a plan that another build of the program has made. Errors: InvalidArgument.
Status checkTool(const std::string& job_folder, const Plan& plan);
// True where the folder has a plan that another build of the program has made.
bool holdsPlanOfAnotherBuild(const std::string& job_folder);

}  // namespace fourdvt::jobs
