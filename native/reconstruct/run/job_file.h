// SPDX-License-Identifier: Apache-2.0
// The file of a job folder from which every piece of a reconstruction goes on: options, and what planning found out.
#pragma once

#include "reconstruct/run/prepare.h"

namespace fourdvt::reconstruct {

struct JobFile {
  Prepared job;                      // without its capture, which a piece opens as far as it reads it
  uint64_t common_input_digest = 0;  // see capture/input_files.h, of the new folder
};

// Errors: WriteFailed.
Status writeJobFile(const std::string& job_folder, const JobFile& file);
// Errors: FileMissing; FileUnreadable (damaged, or of another version).
Result<JobFile> readJobFile(const std::string& job_folder);

}  // namespace fourdvt::reconstruct
