// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/text.h"
#include "report/document.h"

namespace fourdvt::report {
namespace {

constexpr int kRow = 30, kLabel = 120, kWidth = 640, kValue = 120;

std::string textAt(const char* style, double x, int y, const std::string& text) {
  return printed("<text class=\"%s\" x=\"%.1f\" y=\"%d\">", style, x, y) + htmlEscaped(text) + "</text>";
}

std::string barSvg(const Bar& bar, double length, int y) {
  return textAt("label", kLabel - 12, y + 19, bar.label) +
         printed("<rect x=\"%d\" y=\"%d\" width=\"%.1f\" height=\"18\" rx=\"3\"/>", kLabel, y + 5, length) +
         textAt("value", kLabel + length + 8, y + 19, bar.text) + "\n";
}

}  // namespace

std::string barsSvg(const BarChart& chart) {
  double largest = 1e-12;
  for (const Bar& bar : chart.bars) largest = std::max(largest, bar.value);
  const std::string height = std::to_string(kRow * chart.bars.size());
  std::string out = "<svg class=\"bars\" viewBox=\"0 0 " + std::to_string(kWidth) + " " + height +
                    "\" role=\"img\" aria-label=\"" + htmlEscaped(chart.title) + "\">\n";
  int y = 0;
  for (const Bar& bar : chart.bars) {
    out += barSvg(bar, std::max(1.0, (kWidth - kLabel - kValue) * bar.value / largest), y);
    y += kRow;
  }
  return out + "</svg>\n";
}

}  // namespace fourdvt::report
