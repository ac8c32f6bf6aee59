// SPDX-License-Identifier: Apache-2.0
#include "capture/import/csv.h"

#include <algorithm>
#include <cmath>

#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr const char* kRemedy = "; export the calibration again";

char separatorOf(std::string_view line) {
  for (const char separator : {',', ';', '\t'})
    if (line.find(separator) != line.npos) return separator;
  return 0;
}

std::vector<std::string> cellsOf(std::string_view line, char separator) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      out.emplace_back();
    else
      out.back() += c;
  }
  for (std::string& cell : out) cell = std::string(trimmed(cell));
  return out;
}

}  // namespace

Result<double> CsvTable::Row::number(const std::string& column) const {
  const auto cell = cells.find(column);
  const std::string word = cell == cells.end() ? std::string() : cell->second;
  const auto value = toNumber<double>(word);
  if (value && std::isfinite(*value)) return *value;
  return Error{ErrorId::CameraPose, where + "column " + column + ": " + numberProblem(word) + kRemedy};
}

Result<double> CsvTable::Row::orZero(const std::string& column) const {
  const auto cell = cells.find(column);
  if (cell == cells.end() || cell->second.empty()) return 0.0;
  return number(column);
}

bool CsvTable::has(std::initializer_list<const char*> names) const {
  return std::all_of(names.begin(), names.end(),
                     [&](const char* name) { return std::count(columns.begin(), columns.end(), name) > 0; });
}

Result<CsvTable> parseCsv(std::string_view text, const std::string& path) {
  CsvTable out;
  TextLines lines(text, {.comment = 0});
  std::string_view line;
  char separator = 0;
  while (!separator && lines.next(line)) separator = separatorOf(line);
  if (!separator) return out;
  out.columns = cellsOf(line, separator);
  while (lines.next(line)) {
    const std::vector<std::string> cells = cellsOf(line, separator);
    CsvTable::Row row{{}, atLine(path, lines.number())};
    const bool padded = std::all_of(cells.begin() + static_cast<long>(std::min(cells.size(), out.columns.size())),
                                    cells.end(), [](const std::string& cell) { return cell.empty(); });
    if (!padded) {
      return Error{ErrorId::CameraPose, row.where + "has " + std::to_string(cells.size()) +
                                            " values, but the first line names " + std::to_string(out.columns.size()) +
                                            " columns (if numbers have decimal commas, write 1.5, not 1,5)" + kRemedy};
    }
    for (size_t i = 0; i < std::min(cells.size(), out.columns.size()); ++i) row.cells[out.columns[i]] = cells[i];
    out.rows.push_back(std::move(row));
  }
  return out;
}

}  // namespace fourdvt::capture
