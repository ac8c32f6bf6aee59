// SPDX-License-Identifier: Apache-2.0
// Tables and curves of the report as data: a row and a column each fix method, setting and quantity; together they
// select a value of the study's rows.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/study/tables/report.h"

namespace fourdvt::study {

using NumberText = std::string (*)(double value);
// Fixed decimals, as a NumberText.
template <int decimals>
std::string fixed(double value) {
  return fixedText(value, decimals);
}
inline std::string times(double ratio) { return std::isnan(ratio) ? "–" : fixedText(ratio, 2) + " ×"; }
// Usual text of a quantity, by its unit (rows::unitOf); SSIM has four decimals.
NumberText textOf(const char* quantity);

// Cell description, merged from GridOptions::all, its row and its column, in this order: method, filter and sequence
// are concatenated; for all other members the last one set counts.
struct Cell {
  std::vector<std::string> title;  // row titles may span several cells
  std::string method, filter;      // see StudyValues
  const char* quantity = nullptr;
  NumberText text = nullptr;     // default: textOf(quantity)
  const char* over = nullptr;    // shows the ratio to this quantity
  const char* beside = nullptr;  // second quantity, "24.1 / 0.7712"
  std::string sequence = {};     // "": over all sequences
  // Replaces `quantity`: computed from several quantities.
  std::function<double(const StudyValues& values, const Cell& cell)> value = {};
  // Replaces all of the above by words; a row of words alone counts as empty.
  std::function<std::string(const StudyValues& values, const Cell& cell)> words = {};
};
using Cells = std::vector<Cell>;

struct GridOptions {
  const char* table;  // table of the rows
  std::string title, note;
  std::vector<std::string> corner;  // titles above the cells of the rows' titles
  Cell all = {};                    // common part of all cells
};
// Adds a table without its empty rows; nothing if no rows remain.
void addGrid(Section& section, const StudyValues& v, const GridOptions& options, const Cells& rows,
             const Cells& columns);
// Adds a table unless it has no rows.
void addTable(Section& section, Table table);

// One cell per method of the table, in the report's order.
Cells methodsOf(const StudyValues& v, const char* table);
// One cell per value of a setting's key, in order of appearance; of this method, if given.
Cells settingsOf(const StudyValues& v, const char* table, const std::string& method, const std::string& key,
                 const std::string& before = {});

// Cells that differ in quantity alone.
struct Shown {
  std::string title;
  const char* quantity;
  NumberText text = nullptr;
  const char* over = nullptr;
};
Cells cellsOf(const std::vector<Shown>& quantities);

struct NumbersOptions {
  const char* table;
  std::string method, key;  // empty method: all
  int decimals = 0;
  std::string before = {}, after = {};  // around the number in the title
};
// One cell per value of a setting's key, ascending.
Cells numbersOf(const StudyValues& v, const NumbersOptions& options);

struct CurvesOptions {
  const char *table, *quantity;
  std::string x_key;  // key of the settings
  int x_decimals = 0;
  std::string title, x_label, y_label;
  std::string filter = {};
  std::optional<double> reduction_from = {};                // y: reduction against this value, percent
  std::optional<std::pair<double, std::string>> base = {};  // x and filter of one more point, which is no curve alone
};
// Adds one curve per cell with points; nothing if no curves remain.
void addCurves(Section& section, const StudyValues& v, const CurvesOptions& options, const Cells& curves);

}  // namespace fourdvt::study
