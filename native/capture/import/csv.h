// SPDX-License-Identifier: Apache-2.0
// Tables of comma-separated values: a line of names, then rows. Does NOT read cells that hold line ends.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace fourdvt::capture {

struct CsvTable {
  struct Row {
    std::map<std::string, std::string> cells;  // by column
    std::string where;                         // "path:line: "
    // The cell, which must be a finite number. Errors: CameraPose.
    Result<double> number(const std::string& column) const;
    // 0 where there is no such column, or its cell is empty.
    Result<double> orZero(const std::string& column) const;
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;
  bool has(std::initializer_list<const char*> names) const;
};

// Semicolons or tabs part the cells where the first line has them and no commas; cells may be in quotes. Lines before
// the first one with several cells are skipped. Errors: CameraPose (a row with more cells than there are columns:
// decimal commas make them).
Result<CsvTable> parseCsv(std::string_view text, const std::string& path);

}  // namespace fourdvt::capture
