// SPDX-License-Identifier: Apache-2.0
// State of one running bake.
#pragma once

#include <future>
#include <string>

#include "bake/run/job.h"
#include "bake/run/options.h"
#include "bake/run/stage_table.h"
#include "bake/run/work_folder.h"
#include "base/watch.h"

namespace fourdvt::bake {

// Progress of one bake: stage, frames, and remaining time, estimated from the work done so far. Output is the
// listener's.
class ProgressReporter {
 public:
  explicit ProgressReporter(const BakeEnvironment& environment) : environment_(environment) {}
  uint32_t frames_done = 0, frames_total = 0;  // frames of the streams; frames_done includes those of earlier runs

  void expect(double work) { left_ += work; }
  void skip(double work) { left_ -= work; }
  void worked(double work) { done_ += work, left_ -= work; }
  double seconds() const { return watch_.seconds(); }
  void tell(const std::string& stage, double frames_per_s = 0) const {
    if (!environment_.progress) return;
    const double left = done_ > 0 && left_ > 0 ? seconds() * left_ / done_ : 0;
    environment_.progress({stage, frames_done, frames_total, frames_per_s, left});
  }

 private:
  const BakeEnvironment& environment_;
  const Watch watch_;
  double done_ = 0, left_ = 0;
};

// One stage's share of the work while it runs. done(0…1) may be called in any steps; the remainder counts as skipped
// when the object is destroyed.
class StageProgress {
 public:
  StageProgress(ProgressReporter& reporter, double work) : reporter_(reporter), work_(work) {}
  ~StageProgress() { reporter_.skip(work_ - done_); }
  StageProgress(const StageProgress&) = delete;
  StageProgress& operator=(const StageProgress&) = delete;
  void done(double share, const std::string& stage) {
    reporter_.worked(share * work_ - done_);
    done_ = share * work_;
    reporter_.tell(stage);
  }

 private:
  ProgressReporter& reporter_;
  const double work_;
  double done_ = 0;
};

// Shared state of the stages, created by bake.cpp. Borrows the environment's objects.
struct BakeRun {
  BakeRun(Job validated, const BakeEnvironment& given)
      : job(std::move(validated)), environment(given), progress(environment) {}

  gpu::Device& device() const { return *environment.device; }
  std::launch lane() const { return job.options.jobs > 1 ? std::launch::async : std::launch::deferred; }
  bool stopped() const { return environment.stop && *environment.stop; }
  // Called between frames: error Interrupted after a stop request. `kept` names the data that stays on disk
  // ("finished GOPs").
  Status checkStop(const std::string& kept, const std::string& folder) const {
    if (!stopped()) return {};
    const char* how = environment.writer.empty() ? "run the same command with --resume to go on" : "run it again";
    return Error{ErrorId::Interrupted, "stopped; " + kept + " are kept in " + folder + "; " + how};
  }
  Status checkStop() const { return checkStop("finished GOPs", work.path()); }

  Job job;  // validated; planStreams completes it
  const BakeEnvironment environment;
  WorkFolder work;  // opened once the plan is complete
  StageClock clock;
  ProgressReporter progress;
};

}  // namespace fourdvt::bake
