// SPDX-License-Identifier: Apache-2.0
// A stream's two files, from what the work folder holds: the .mp4 of all GOPs, and the .bin of header and chunks.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bake/run/bake_run.h"
#include "bake/video/mp4.h"
#include "package/character.h"

namespace fourdvt::bake {

constexpr const char* kGenerator = "fourdvt 0.1.0";

// Writes the videos of all renditions of `sequence`, which describeStream made, and sets what is now known of them:
// names, bytes, codecs, and their order, the fewest bytes first. Returns their sample tables in that order. Errors:
// WriteFailed, Internal.
Result<std::vector<package::SampleTable>> packVideos(const StreamPlan& plan, const BakeRun& run,
                                                     package::Sequence& sequence);

// Writes the .bin, with one chunk in memory at a time, and sets the sequence's stream fields. The
// index's chunks have no offsets yet. Errors: InvalidArgument (memory limits), WriteFailed, Internal.
Status writeStream(package::StreamIndex index, const BakeRun& run, const StreamPlan& plan, package::Sequence& sequence);

// Library → version of what coded the pictures.
std::vector<std::pair<std::string, std::string>> encoderVersions();

}  // namespace fourdvt::bake
