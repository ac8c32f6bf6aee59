// SPDX-License-Identifier: Apache-2.0
// Records of a job's pieces: one file per start, which remains if the attempt dies, and one per finished piece with its
// cost; and the report over all of them (report.cpp). Modification times are ignored, since clocks of machines differ.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "base/watch.h"
#include "jobs/plan.h"

namespace fourdvt::jobs {

struct Record {
  std::string id, kind, host;
  double seconds = 0, cpu_s = 0;  // wall clock and processor time
  double peak_mb = 0;             // resident memory
  double read_mb = 0, written_mb = 0;
  uint32_t attempt = 1;  // 1: the first start succeeded
};

// One start of a piece by this process.
class Attempt {
 public:
  // Errors: WriteFailed.
  static Result<Attempt> begin(const std::string& job_folder, const Piece& piece);
  // Writes the record unless the piece has one: if two attempts compute a piece at once, the first to finish counts.
  Result<Record> finish();

 private:
  std::string folder_;
  Piece piece_;
  uint32_t number_ = 1;
  Watch watch_;
};

struct Progress {
  std::map<std::string, Record> done;        // keyed by id
  std::map<std::string, uint32_t> attempts;  // keyed by id; pieces without a start are absent
};

bool isDone(const std::string& job_folder, const Piece& piece);
// Reads all records; one that does not parse counts as absent.
Progress readProgress(const std::string& job_folder, const Plan& plan);
// Errors: InvalidArgument, with the unfinished pieces that `piece` needs.
Status checkNeeds(const std::string& job_folder, const Plan& plan, const Piece& piece);

inline constexpr const char* kReportHtml = "job.html";
inline constexpr const char* kReportJson = "job.json";

// Writes the report, with cost, slowest pieces and pieces with several starts, as HTML and JSON into the job folder.
// Errors: WriteFailed.
Status writeReport(const std::string& job_folder, const Plan& plan, const Progress& progress);
// "123 of 456 pieces, 3 started again, about 12 min of work left", extrapolated from the seconds of finished pieces.
std::string progressLine(const Plan& plan, const Progress& progress);

}  // namespace fourdvt::jobs
