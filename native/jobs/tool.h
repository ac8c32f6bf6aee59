// SPDX-License-Identifier: Apache-2.0
// Identity of the running program.
#pragma once

#include <functional>
#include <string>

namespace fourdvt::jobs {

struct Tool {
  std::string version;
  // Hash of the program's file and of the shared libraries that are loaded when it starts, preloaded ones too (their
  // build-ids, else names and sizes): encoders, decoders and mathematics are theirs. Graphics drivers, which are loaded
  // later, are not in it.
  std::string build;
  std::string program;  // its absolute path
};

const Tool& thisTool();

// The key of a job folder's settings. Pieces may be computed by machines on which another build is installed, so that a
// plan's key has the build in it; what one process has left is taken on by a plan, and the other way round. `holds`:
// true if the folder has work with a key. `in_pieces`: false in a command that does all in one process.
std::string folderKey(const std::string& settings, bool in_pieces,
                      const std::function<bool(const std::string& key)>& holds);

}  // namespace fourdvt::jobs
