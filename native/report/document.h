// SPDX-License-Identifier: Apache-2.0
// Report as a self-contained HTML page: tables, SVG plots and bars, pictures by relative file name. The bake report and
// the study report are both documents.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/text.h"

namespace fourdvt::report {

struct Table {
  std::string title, note;  // note: text below the table, may be empty
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // first cell: name of the row
};

struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;  // ascending x
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
};

struct Bar {
  std::string label, text;  // text: formatted value
  double value = 0;         // nonnegative; bar lengths are relative to the chart's maximum
};

struct BarChart {
  std::string title;
  std::vector<Bar> bars;
};

struct Picture {
  std::string file, caption;  // path relative to the page
  int width = 0, height = 0;  // pixels; 0: unknown
};

struct Tile {
  std::string value, meaning;  // headline figure
};

struct Section {
  std::string id, title, text;  // text: paragraphs separated by blank lines, `code` in backticks
  std::vector<Table> tables;
  std::vector<Plot> plots;
  std::vector<Picture> pictures;
  std::vector<Tile> tiles;
  std::vector<BarChart> bar_charts;
};

struct Document {
  std::string title, subtitle;
  std::vector<Section> sections;
  Picture poster;      // picture beside the title; no file: none
  std::string credit;  // footer, may be empty
};

// Plot area within the viewBox; its corners are the ends of the axes.
constexpr double kPlotLeft = 66, kPlotTop = 14, kPlotWidth = 540, kPlotHeight = 290;

// Range and ticks of an axis over finite values. Linear: multiples of 1, 2 or 5 · 10^k, with ends rounded outwards to
// them. Logarithmic (values > 0): the values themselves if there are at most 8 distinct ones and `own_ticks`; else 1,
// 2, 5 · 10^k, or powers of ten over more than three decades.
struct Axis {
  double low = 0, high = 1;
  bool log = false;
  std::vector<double> ticks;         // ascending, inside [low, high]
  double share(double value) const;  // position on the axis: 0 at low, 1 at high
};
Axis makeAxis(const std::vector<double>& values, bool log, bool own_ticks);

// Standalone SVG, accessible (title and description), light and dark by CSS variables, without scripts. Points that are
// not finite, or not positive on a logarithmic axis, interrupt their curve.
std::string plotSvg(const Plot& plot);
// Horizontal bars with labels and values; coloured by the page's CSS.
std::string barsSvg(const BarChart& chart);
// Page as HTML. Cells that begin with "✓" or "✗" are coloured as verdicts; columns of words wrap, columns of figures do
// not.
std::string documentHtml(const Document& document);

// Numbers in suitable units, few digits, "–" for NaN.
std::string fixedText(double value, int decimals);  // prints a minus sign (U+2212) and "∞"
std::string percentText(double percent);            // 0..100
std::string bytesText(double bytes);
std::string secondsText(double seconds);
std::string bitrateText(double bits_per_s);

}  // namespace fourdvt::report
