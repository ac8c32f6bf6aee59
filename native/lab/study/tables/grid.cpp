// SPDX-License-Identifier: Apache-2.0
#include "lab/study/tables/grid.h"

#include <algorithm>
#include <cmath>

#include "lab/study/run/rows.h"

namespace fourdvt::study {
namespace {

Cell merged(Cell a, const Cell& b) {
  a.method += b.method;
  a.filter = b.filter + (a.filter.empty() ? "" : " " + a.filter);
  a.sequence += b.sequence;
  if (b.quantity) a.quantity = b.quantity;
  if (b.text) a.text = b.text;
  if (b.over) a.over = b.over;
  if (b.beside) a.beside = b.beside;
  if (b.value) a.value = b.value;
  if (b.words) a.words = b.words;
  return a;
}

double valueOf(const StudyValues& v, const char* table, const Cell& cell, const char* quantity) {
  return cell.sequence.empty() ? v.mean(table, cell.method, cell.filter, quantity)
                               : v.of(table, cell.sequence, cell.method, cell.filter, quantity);
}

double valueOf(const StudyValues& v, const char* table, const Cell& cell) {
  if (cell.words) return std::nan("");
  if (cell.value) return cell.value(v, cell);
  const double value = valueOf(v, table, cell, cell.quantity);
  return cell.over ? value / valueOf(v, table, cell, cell.over) : value;
}

std::string shownText(const StudyValues& v, const char* table, const Cell& cell, double value) {
  if (cell.words) return cell.words(v, cell);
  const std::string text = (cell.text ? cell.text : textOf(cell.quantity))(value);
  return cell.beside ? text + " / " + textOf(cell.beside)(valueOf(v, table, cell, cell.beside)) : text;
}

}  // namespace

NumberText textOf(const char* quantity) {
  static constexpr std::pair<const char*, NumberText> kTexts[] = {{"bytes", bytesText}, {"bit/s", bitrateText},
                                                                  {"s", secondsText},   {"1/s", fixed<1>},
                                                                  {"mm", fixed<1>},     {"percent", percentText}};
  const std::string unit = rows::unitOf(quantity);
  for (const auto& [name, text] : kTexts)
    if (unit == name) return text;
  return std::string(quantity).find("ssim") == std::string::npos ? fixed<2> : fixed<4>;
}

void addTable(Section& section, Table table) {
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

void addGrid(Section& section, const StudyValues& v, const GridOptions& options, const Cells& rows,
             const Cells& columns) {
  Table table{options.title, options.note, options.corner, {}};
  for (const Cell& column : columns) table.columns.push_back(column.title.front());
  for (const Cell& row : rows) {
    std::vector<std::string> texts = row.title;
    bool any = false;
    for (const Cell& column : columns) {
      const Cell cell = merged(merged(options.all, row), column);
      const double value = valueOf(v, options.table, cell);
      any |= !std::isnan(value);
      texts.push_back(shownText(v, options.table, cell, value));
    }
    if (any) table.rows.push_back(std::move(texts));
  }
  addTable(section, std::move(table));
}

Cells methodsOf(const StudyValues& v, const char* table) {
  Cells out;
  for (const std::string& method : v.methods(table)) out.push_back({{methodTitle(method)}, method});
  return out;
}

Cells settingsOf(const StudyValues& v, const char* table, const std::string& method, const std::string& key,
                 const std::string& before) {
  Cells out;
  for (const std::string& text : v.settings(table, method, key))
    out.push_back({{before + text}, method, key + "=" + text});
  return out;
}

Cells cellsOf(const std::vector<Shown>& quantities) {
  Cells out;
  for (const Shown& q : quantities) out.push_back({{q.title}, "", "", q.quantity, q.text, q.over});
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
    const auto add = [&](double x, const std::string& filter) {
      const double y = v.mean(options.table, cell.method, filter + " " + cell.filter, options.quantity);
      const double shown = options.reduction_from ? 100 * (1 - y / *options.reduction_from) : y;
      if (!std::isnan(shown)) curve.points.emplace_back(x, shown);
    };
    if (options.base) add(options.base->first, options.base->second);
    for (const double x : v.numbers(options.table, cell.method, options.x_key))
      add(x, options.x_key + "=" + fixedText(x, options.x_decimals) + " " + options.filter);
    std::sort(curve.points.begin(), curve.points.end());
    if (curve.points.size() > (options.base ? 1 : 0)) plot.curves.push_back(std::move(curve));
  }
  if (!plot.curves.empty()) section.plots.push_back(std::move(plot));
}

}  // namespace fourdvt::study
