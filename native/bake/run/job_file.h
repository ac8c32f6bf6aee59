// SPDX-License-Identifier: Apache-2.0
// Stores a planned job in a file, so that another process continues without reading the capture again.
#pragma once

#include <string>

#include "bake/run/job.h"

namespace fourdvt::bake {

// Leaves out the cameras' regions, from which the streams are planned, the pictures of a refinement, and the lab's
// rules for labels and texels. Errors: WriteFailed.
Status saveJob(const std::string& path, const Job& job);
// Errors: those of store::load.
Result<Job> loadJob(const std::string& path);

}  // namespace fourdvt::bake
