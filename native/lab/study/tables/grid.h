// SPDX-License-Identifier: Apache-2.0
// Tables and curves of the report as data: what a row and what a column fix (method, setting, quantity), and the value
// that both together name among the study's rows. Does NOT know which tables there are.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
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

// What a cell takes from GridOptions::all, its row and its column, joined in this order: method, filter and sequence
// are put together; of everything else the last one that is set counts.
struct Cell {
  std::vector<std::string> title;  // a row's may have several cells
  std::string method, filter;      // as StudyValues
  const char* quantity = nullptr;
  NumberText text = nullptr;
  const char* over = nullptr;    // the value is the quantity's ratio to this one
  const char* beside = nullptr;  // a second quantity, "24.1 / 0.7712"
  NumberText beside_text = nullptr;
  std::string sequence = {};  // "": over all sequences
  // Instead of `quantity`: from several quantities.
  std::function<double(const StudyValues& values, const Cell& cell)> value = {};
};
using Cells = std::vector<Cell>;

struct GridOptions {
  const char* table;  // of the rows
  std::string title, note;
  std::vector<std::string> corner;  // titles of the cells that the rows' titles stand in
  Cell all = {};                    // what all cells have in common
};
// Rows without any value are left out; no rows: nothing is added.
void addGrid(Section& section, const StudyValues& v, const GridOptions& options, const Cells& rows,
             const Cells& columns);

// A cell per method of the table, in the report's order.
Cells methodsOf(const StudyValues& v, const char* table);

struct NumbersOptions {
  const char* table;
  std::string method, key;  // method: empty for all
  int decimals = 0;
  std::string before = {}, after = {};  // of the number in the title
};
// A cell per value of a setting's key, ascending.
Cells numbersOf(const StudyValues& v, const NumbersOptions& options);

struct CurvesOptions {
  const char *table, *quantity;
  std::string x_key;  // a key of the settings
  int x_decimals = 0;
  std::string title, x_label, y_label;
  std::string filter = {};
  std::optional<double> reduction_from = {};  // y: reduction against this value, percent
};
// A curve per cell; curves without points are left out, no curves: nothing is added.
void addCurves(Section& section, const StudyValues& v, const CurvesOptions& options, const Cells& curves);

}  // namespace fourdvt::study
