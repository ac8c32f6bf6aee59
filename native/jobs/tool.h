// SPDX-License-Identifier: Apache-2.0
// Identity of the running program and of the machine.
#pragma once

#include <string>

namespace fourdvt::jobs {

struct Tool {
  std::string version, build, program;  // build: hash of the program's file; program: its absolute path
};

const Tool& thisTool();
std::string hostName();

}  // namespace fourdvt::jobs
