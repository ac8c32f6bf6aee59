// SPDX-License-Identifier: Apache-2.0
// One bake while it runs: what its stages share. bake.cpp makes it and hands it from stage to stage. Borrows what the
// environment points to. Does NOT decide what is done.
#pragma once

#include "bake/run/environment.h"
#include "bake/run/job.h"
#include "bake/run/progress.h"
#include "bake/run/stage_clock.h"
#include "bake/run/work_folder.h"

namespace fourdvt::bake {

struct BakeRun {
  BakeRun(Job validated, const BakeEnvironment& given)
      : job(std::move(validated)), environment(given), progress(environment) {}

  gpu::Device& device() const { return *environment.device; }
  bool stopped() const { return environment.stop && *environment.stop; }
  // Called between frames: error Interrupted once a stop was asked for. `kept` names what stays on disk ("finished
  // GOPs").
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
