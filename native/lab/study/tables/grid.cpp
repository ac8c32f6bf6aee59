// SPDX-License-Identifier: Apache-2.0
#include "lab/study/tables/grid.h"

#include <cmath>

namespace fourdvt::study {
namespace {

Cell joined(Cell a, const Cell& b) {
  a.method += b.method;
  a.filter += " " + b.filter;
  a.sequence += b.sequence;
  if (b.quantity) a.quantity = b.quantity;
  if (b.text) a.text = b.text;
  if (b.over) a.over = b.over;
  if (b.beside) a.beside = b.beside, a.beside_text = b.beside_text;
  if (b.value) a.value = b.value;
  return a;
}

double valueOf(const StudyValues& v, const char* table, const Cell& cell, const char* quantity) {
  return cell.sequence.empty() ? v.mean(table, cell.method, cell.filter, quantity)
                               : v.of(table, cell.sequence, cell.method, cell.filter, quantity);
}

double valueOf(const StudyValues& v, const char* table, const Cell& cell) {
  if (cell.value) return cell.value(v, cell);
  const double value = valueOf(v, table, cell, cell.quantity);
  return cell.over ? value / valueOf(v, table, cell, cell.over) : value;
}

std::string textOf(const StudyValues& v, const char* table, const Cell& cell, double value) {
  const std::string text = cell.text(value);
  return cell.beside ? text + " / " + cell.beside_text(valueOf(v, table, cell, cell.beside)) : text;
}

}  // namespace

void addGrid(Section& section, const StudyValues& v, const GridOptions& options, const Cells& rows,
             const Cells& columns) {
  Table table{options.title, options.note, options.corner, {}};
  for (const Cell& column : columns) table.columns.push_back(column.title.front());
  for (const Cell& row : rows) {
    std::vector<std::string> texts = row.title;
    bool any = false;
    for (const Cell& column : columns) {
      const Cell cell = joined(joined(options.all, row), column);
      const double value = valueOf(v, options.table, cell);
      any |= !std::isnan(value);
      texts.push_back(textOf(v, options.table, cell, value));
    }
    if (any) table.rows.push_back(std::move(texts));
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

Cells methodsOf(const StudyValues& v, const char* table) {
  Cells out;
  for (const std::string& method : v.methods(table)) out.push_back({{methodTitle(method)}, method});
  return out;
}

Cells numbersOf(const StudyValues& v, const NumbersOptions& options) {
  Cells out;
  for (const double number : v.numbers(options.table, options.method, options.key)) {
    const std::string text = fixedText(number, options.decimals);
    out.push_back({{options.before + text + options.after}, "", options.key + "=" + text});
  }
  return out;
}

void addCurves(Section& section, const StudyValues& v, const CurvesOptions& options, const Cells& curves) {
  Plot plot{options.title, options.x_label, options.y_label, false, false, {}};
  for (const Cell& cell : curves) {
    Curve curve{cell.title.front(), {}};
    for (const double x : v.numbers(options.table, cell.method, options.x_key)) {
      const std::string filter =
          options.x_key + "=" + fixedText(x, options.x_decimals) + " " + options.filter + " " + cell.filter;
      const double y = v.mean(options.table, cell.method, filter, options.quantity);
      const double shown = options.reduction_from ? 100 * (1 - y / *options.reduction_from) : y;
      if (!std::isnan(shown)) curve.points.emplace_back(x, shown);
    }
    if (!curve.points.empty()) plot.curves.push_back(std::move(curve));
  }
  if (!plot.curves.empty()) section.plots.push_back(std::move(plot));
}

}  // namespace fourdvt::study
