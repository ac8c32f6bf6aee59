// SPDX-License-Identifier: Apache-2.0
// Identity of the running program and of the machine.
#pragma once

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
std::string hostName();

}  // namespace fourdvt::jobs
