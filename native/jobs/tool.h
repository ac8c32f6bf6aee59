// SPDX-License-Identifier: Apache-2.0
// Identity of the running program.
#pragma once

#include <functional>
#include <string>

namespace fourdvt::jobs {

struct Tool {
  std::string version;
  // Hash of the program's file and of the shared libraries loaded at start, including preloaded ones (build-ids, or
  // else names and sizes), since codecs and mathematics reside there. Graphics drivers load later and are excluded.
  std::string build;
  std::string program;  // absolute path
};

const Tool& thisTool();

// Key of a job folder's settings. Machines with another build may compute pieces, so a plan's key contains the build; a
// plan resumes the work of a single process and vice versa. `holds`: true if the folder has work with a key.
// `in_pieces`: false in a command that does all in one process.
std::string folderKey(const std::string& settings, bool in_pieces,
                      const std::function<bool(const std::string& key)>& holds);

}  // namespace fourdvt::jobs
