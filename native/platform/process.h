// SPDX-License-Identifier: Apache-2.0
// Name and usage of the running process.
#pragma once

#include <cstdint>
#include <string>

namespace fourdvt::platform {

std::string hostName();
// End of a file's name that no other process has, on this machine or on one that shares its files: "HOST.PID".
std::string ownSuffix();

struct ProcessUsage {
  double cpu_s = 0;                            // of all threads, in user and in kernel mode
  uint64_t peak_bytes = 0;                     // resident memory
  uint64_t read_bytes = 0, written_bytes = 0;  // by system calls; what a page cache answers counts too
};
ProcessUsage processUsage();  // so far

}  // namespace fourdvt::platform
