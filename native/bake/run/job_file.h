// SPDX-License-Identifier: Apache-2.0
// A planned job as bytes, so that another process goes on with it without reading the capture again. Only the build
// that wrote them reads them: this is not a format.
#pragma once

#include <span>
#include <vector>

#include "bake/run/job.h"

namespace fourdvt::bake {

// Does not include the cameras' regions, from which the streams are planned, the pictures of a refinement, which only
// its report shows, nor the lab's rules for labels and texels.
std::vector<uint8_t> jobBytes(const Job& job);
// False if the bytes are not exactly one job.
bool jobFrom(std::span<const uint8_t> bytes, Job& job);

}  // namespace fourdvt::bake
