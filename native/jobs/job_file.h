// SPDX-License-Identifier: Apache-2.0
// State of a job from which every piece continues, written by planning: JOB/job.bin.
#pragma once

#include <string>

#include "store/folder.h"

namespace fourdvt::jobs {

inline constexpr const char* kJobFile = "/job.bin";

// Errors: WriteFailed.
template <class State>
Status writeJobFile(const std::string& job_folder, const State& state) {
  return store::save(job_folder + kJobFile, state);
}

// Errors: FileMissing; FileUnreadable (damaged, or of another version).
template <class State>
Result<State> readJobFile(const std::string& job_folder) {
  const std::string path = job_folder + kJobFile;
  auto state = store::load<State>(path);
  if (state) return state;
  if (state.error().id == ErrorId::FileMissing)
    return Error{ErrorId::FileMissing, path + ": there is none; run `fourdvt plan` again"};
  return Error{ErrorId::FileUnreadable,
               path + ": damaged, or of another version; delete it and run `fourdvt plan` again"};
}

}  // namespace fourdvt::jobs
