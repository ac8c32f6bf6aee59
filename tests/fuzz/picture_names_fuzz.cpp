// SPDX-License-Identifier: Apache-2.0
// Names of a folder's pictures, one per line, from an untrusted source.
#include <cstdlib>
#include <string_view>

#include "capture/import/views.h"
#include "capture/text.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size), line;
  std::vector<std::string> names;
  while (fourdvt::capture::takeLine(text, line)) names.emplace_back(line);
  const auto numbers = fourdvt::capture::pictureNumbers(names);
  if (numbers.size() != names.size()) std::abort();
  for (const int64_t number : numbers)
    if (number < -1) std::abort();
  return 0;
}
