// SPDX-License-Identifier: Apache-2.0
// Time stamps of a capture's videos, listed once while planning: pieces that begin far inside a video without an index
// would each read all of it.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::jobs {

// For platform::openIndexedVideo.
std::string videoIndexFolder(const std::string& job_folder);

// Returns when all are listed. Errors: those of platform::indexVideo; WriteFailed; Interrupted once `stop`, if there is
// one, is set.
Status indexVideos(const std::string& job_folder, const std::vector<std::string>& paths, const std::atomic<bool>* stop);

}  // namespace fourdvt::jobs
