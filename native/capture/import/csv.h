// SPDX-License-Identifier: Apache-2.0
// Tables of comma-separated values: a line of names, then rows. Cells end with their line.
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
    // Cell as a finite number. Errors: CameraPose.
    Result<double> number(const std::string& column) const;
    // Cell as a number; 0 for a missing column or an empty cell.
    Result<double> orZero(const std::string& column) const;
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;
  bool has(std::initializer_list<const char*> names) const;
};

// Parses a table. Cells are separated by semicolons or tabs where the first line has them and no commas; cells may be
// in quotes. Lines before the first one with several cells are skipped. Errors: CameraPose (more cells than columns in
// a row, e.g. by decimal commas).
Result<CsvTable> parseCsv(std::string_view text, const std::string& path);

}  // namespace fourdvt::capture
