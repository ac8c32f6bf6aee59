// SPDX-License-Identifier: Apache-2.0
// Name, usage and memory of the running process.
#pragma once

#include <cstdint>
#include <string>

namespace fourdvt::platform {

std::string hostName();
// File name suffix unique to this process among all machines that share its files: "HOST.PID".
std::string ownSuffix();

struct ProcessUsage {
  double cpu_s = 0;                            // all threads, user and kernel mode
  uint64_t peak_bytes = 0;                     // resident memory
  uint64_t read_bytes = 0, written_bytes = 0;  // by system calls, page cache included
};
ProcessUsage processUsage();  // since the process started

// Keeps freed memory for later allocations, so that the system need not clear its pages again. For processes that free
// and allocate large blocks in turn.
void keepFreedMemory();

}  // namespace fourdvt::platform
