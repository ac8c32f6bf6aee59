// SPDX-License-Identifier: Apache-2.0
// Records of a job's pieces: a file for every start of a piece, which an attempt that dies leaves behind, and one for
// every piece that is finished, with its cost. Modification times mean nothing: clocks of machines differ.
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
  // Writes the record, unless the piece has one already: of two that computed it at once the first counts.
  Result<Record> finish();

 private:
  std::string folder_;
  Piece piece_;
  uint32_t number_ = 1;
  Watch watch_;
};

struct Progress {
  std::map<std::string, Record> done;        // by id
  std::map<std::string, uint32_t> attempts;  // by id; pieces that were never started are not in it
};

bool isDone(const std::string& job_folder, const Piece& piece);
// A record that does not parse counts as absent.
Progress readProgress(const std::string& job_folder, const Plan& plan);
// Error InvalidArgument that names pieces which `piece` needs and which are not done.
Status checkNeeds(const std::string& job_folder, const Plan& plan, const Piece& piece);

}  // namespace fourdvt::jobs
