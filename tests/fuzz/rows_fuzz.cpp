// SPDX-License-Identifier: Apache-2.0
// Rows of a study as left by an interrupted run: accepted rows are unchanged after writing and reading them again.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "lab/study/run/row_writer.h"

using namespace fourdvt::study;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  auto rows = parseRowsCsv(text, "rows.csv");
  if (!rows) return 0;
  auto again = parseRowsCsv(rowsCsv(rows.value()), "rows.csv");
  if (!again || again.value().size() != rows.value().size()) std::abort();
  for (size_t i = 0; i < rows.value().size(); ++i) {
    const Row &a = rows.value()[i], &b = again.value()[i];
    if (a.table != b.table || a.sequence != b.sequence || a.method != b.method || a.setting != b.setting ||
        a.quantity != b.quantity || a.unit != b.unit)
      std::abort();
    const bool same = std::isnan(a.value)
                          ? std::isnan(b.value)
                          : std::isinf(a.value) || std::abs(a.value - b.value) <= 1e-6 * std::abs(a.value);
    if (!same) std::abort();
  }
  return 0;
}
