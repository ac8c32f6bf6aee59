// SPDX-License-Identifier: Apache-2.0
// A planned job in a file, so that another process goes on with it without reading the capture again.
#pragma once

#include <string>

#include "bake/run/job.h"

namespace fourdvt::bake {

// Does not keep the cameras' regions, from which the streams are planned, the pictures of a refinement, nor the lab's
// rules for labels and texels. Errors: WriteFailed.
Status saveJob(const std::string& path, const Job& job);
// Errors: those of store::load.
Result<Job> loadJob(const std::string& path);

}  // namespace fourdvt::bake
