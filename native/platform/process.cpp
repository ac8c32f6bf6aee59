// SPDX-License-Identifier: Apache-2.0
#include "platform/process.h"

#ifdef __linux__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace fourdvt::platform {
namespace {

double secondsOf(const timeval& t) { return double(t.tv_sec) + double(t.tv_usec) / 1e6; }

}  // namespace

std::string hostName() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string ownSuffix() { return hostName() + "." + std::to_string(::getpid()); }

ProcessUsage processUsage() {
  ProcessUsage out;
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  out.cpu_s = secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
#ifdef __APPLE__
  out.peak_bytes = uint64_t(usage.ru_maxrss);
#else
  out.peak_bytes = uint64_t(usage.ru_maxrss) * 1024;
#endif
  std::ifstream io("/proc/self/io");
  std::string name;
  for (uint64_t bytes; io >> name >> bytes;) {
    if (name == "rchar:") out.read_bytes = bytes;
    if (name == "wchar:") out.written_bytes = bytes;
  }
  return out;
}

void keepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kLargest = 1 << 30, kSpare = 1 << 26;  // bytes
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kLargest);
  mallopt(M_TOP_PAD, kSpare);
#endif
}

}  // namespace fourdvt::platform
