// SPDX-License-Identifier: Apache-2.0
#include "jobs/tool.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "base/hash.h"
#include "platform/files.h"

namespace fourdvt::jobs {

const Tool& thisTool() {
  static const Tool tool = [] {
    Tool out{FOURDVT_VERSION, "", ""};
    std::error_code ignored;
    out.program = std::filesystem::read_symlink("/proc/self/exe", ignored).string();
    char digits[17] = "";
    if (const auto bytes = platform::readFile("/proc/self/exe"))
      std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(bytes.value())));
    out.build = digits;
    return out;
  }();
  return tool;
}

std::string hostName() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

}  // namespace fourdvt::jobs
