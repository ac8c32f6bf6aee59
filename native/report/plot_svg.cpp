// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "report/document.h"

namespace fourdvt::report {
namespace {

// Palette distinguishable in colour-blind vision, after Okabe and Ito, "Color Universal Design (CUD): How to Make
// Figures and Presentations That Are Friendly to Colorblind People", J*FLY, 2008; --cN of the page overrides it.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#008f68", "#b0578d",
                                    "#c98500", "#3d9bd1", "#6b7280", "#7a4fbf"};
constexpr const char* kDashes[] = {"", "7 4", "2 3", "10 3 2 3", "5 2", "1 4", "12 4", "3 6"};
constexpr int kStyles = 8, kShapes = 4;
constexpr double kBelow = 52, kRight = 18, kLegendRow = 22, kLetter = 7.3;

// Minimum number of digits that distinguishes the ticks.
std::string tickText(double value, double step) {
  const double size = std::abs(value);
  if (size >= 1e9) return printed("%.4gG", value / 1e9);
  if (size >= 1e6) return printed("%.4gM", value / 1e6);
  if (size >= 1e4) return printed("%.4gk", value / 1e3);
  if (step > 0 && step < 1) return printed("%.*f", static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), value);
  return printed("%.4g", value);
}

double niceStep(double span, int wanted) {
  const double raw = span / wanted, magnitude = std::pow(10.0, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0})
    if (factor * magnitude >= raw * 0.999) return factor * magnitude;
  return 10 * magnitude;
}

void linearTicks(Axis& axis) {
  if (axis.high - axis.low <= 1e-12 * std::max(std::abs(axis.low), std::abs(axis.high)) || axis.high == axis.low) {
    const double room = axis.low == 0 ? 1 : 0.1 * std::abs(axis.low);
    axis.low -= room, axis.high += room;
  }
  const double step = niceStep(axis.high - axis.low, 6);
  const double first = std::floor(axis.low / step + 1e-9), last = std::ceil(axis.high / step - 1e-9);
  for (double i = first; i <= last; ++i) axis.ticks.push_back(i * step);
  axis.low = first * step, axis.high = last * step;
}

// The largest 1, 2, 5 · 10^k at most `value` (down), or the smallest at least `value`.
double nice125(double value, bool down) {
  const double magnitude = std::pow(10.0, std::floor(std::log10(value) + 1e-9));
  double best = down ? magnitude : 10 * magnitude;
  for (double factor : {1.0, 2.0, 5.0}) {
    const double candidate = factor * magnitude;
    if (down && candidate <= value * 1.0000001) best = candidate;
    if (!down && candidate >= value * 0.9999999) return candidate;
  }
  return best;
}

void logTicks(Axis& axis) {
  axis.low = nice125(axis.low, true), axis.high = nice125(axis.high, false);
  if (axis.low == axis.high) axis.low /= 2, axis.high *= 2;
  const bool decades = axis.high / axis.low > 1000;
  for (double magnitude = std::pow(10.0, std::floor(std::log10(axis.low))); magnitude <= axis.high * 1.0001;
       magnitude *= 10)
    for (double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * magnitude;
      if (decades && factor != 1) continue;
      if (tick >= axis.low * 0.9999 && tick <= axis.high * 1.0001) axis.ticks.push_back(tick);
    }
}

bool drawable(const Plot& plot, const std::pair<double, double>& p) {
  return std::isfinite(p.first) && std::isfinite(p.second) && (!plot.log_x || p.first > 0) &&
         (!plot.log_y || p.second > 0);
}

std::string textAt(double x, double y, const char* anchor, const std::string& text, const char* extra = "") {
  return printed("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"%s\"%s>", x, y, anchor, extra) + htmlEscaped(text) +
         "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* style) {
  return printed("<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" style=\"%s\"/>\n", x0, y0, x1, y1, style);
}

std::string colour(size_t index) {
  return "var(--c" + std::to_string(index % kStyles) + "," + kColours[index % kStyles] + ")";
}

std::string dash(size_t index) {
  const std::string pattern = kDashes[index % kStyles];
  return pattern.empty() ? "" : ";stroke-dasharray:" + pattern;
}

// Filled circle, square, diamond or triangle.
std::string marker(size_t index, double x, double y) {
  const std::string style = "\" style=\"fill:" + colour(index) + "\"/>";
  if (index % kShapes == 0) return printed("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"3.6", x, y) + style;
  static constexpr double kCorners[3][4][2] = {{{-3.2, -3.2}, {3.2, -3.2}, {3.2, 3.2}, {-3.2, 3.2}},
                                               {{0, -4.6}, {4.6, 0}, {0, 4.6}, {-4.6, 0}},
                                               {{0, -4.4}, {4.2, 3.2}, {-4.2, 3.2}, {0, -4.4}}};
  std::string points;
  for (const auto& corner : kCorners[index % kShapes - 1])
    points += printed("%s%.2f,%.2f", points.empty() ? "" : " ", x + corner[0], y + corner[1]);
  return "<polygon points=\"" + points + style;
}

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : plot_(plot) {
    std::vector<double> xs, ys;
    for (const Curve& curve : plot.curves)
      for (const auto& p : curve.points)
        if (drawable(plot, p)) xs.push_back(p.first), ys.push_back(p.second);
    empty_ = xs.empty();
    x_ = makeAxis(xs, plot.log_x, true);
    y_ = makeAxis(ys, plot.log_y, false);
  }

  std::string svg() const {
    const Legend legend = empty_ ? Legend{} : legendAt(kPlotTop + kPlotHeight + kBelow + 12);
    const double height = kPlotTop + kPlotHeight + kBelow + kLegendRow * legend.rows;
    std::string out =
        printed(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.2f %.2f\" role=\"img\" class=\"plot\" "
            "style=\"font:13px system-ui,sans-serif;fill:var(--ink,#1d2126)\">\n<title>",
            kPlotLeft + kPlotWidth + kRight, height) +
        htmlEscaped(plot_.title) + "</title>\n<desc>" + htmlEscaped(description()) + "</desc>\n";
    out += empty_ ? textAt(kPlotLeft + kPlotWidth / 2, kPlotTop + kPlotHeight / 2, "middle", "not measured") : grid();
    out += labels();
    if (!empty_)
      for (size_t i = 0; i < plot_.curves.size(); ++i) out += curve(i);
    return out + legend.svg + "</svg>\n";
  }

 private:
  double px(double value) const { return kPlotLeft + kPlotWidth * x_.share(value); }
  double py(double value) const { return kPlotTop + kPlotHeight * (1 - y_.share(value)); }

  std::string description() const {
    std::string out = plot_.y_label + " against " + plot_.x_label + ".";
    for (const Curve& curve : plot_.curves) {
      out += " " + curve.name + ":";
      for (const auto& p : curve.points)
        if (drawable(plot_, p)) out += printed(" %.4g at %.4g;", p.second, p.first);
    }
    return out;
  }

  std::string grid() const {
    constexpr const char* kLine = "stroke:var(--line,#dfe2e5)";
    std::string out;
    auto step = [](const Axis& axis) { return axis.ticks.size() > 1 && !axis.log ? axis.ticks[1] - axis.ticks[0] : 0; };
    for (double tick : y_.ticks) {
      out += line(kPlotLeft, py(tick), kPlotLeft + kPlotWidth, py(tick), kLine);
      out += textAt(kPlotLeft - 9, py(tick) + 4.5, "end", tickText(tick, step(y_)));
    }
    for (double tick : x_.ticks) {
      out += line(px(tick), kPlotTop, px(tick), kPlotTop + kPlotHeight, kLine);
      out += textAt(px(tick), kPlotTop + kPlotHeight + 19, "middle", tickText(tick, step(x_)));
    }
    return out;
  }

  std::string labels() const {
    const double bottom = kPlotTop + kPlotHeight, middle = kPlotTop + kPlotHeight / 2;
    const std::string turned = printed(" transform=\"rotate(-90 15 %.2f)\" style=\"fill:var(--soft,#68717c)\"", middle);
    return line(kPlotLeft, bottom, kPlotLeft + kPlotWidth, bottom, "stroke:var(--soft,#68717c)") +
           textAt(kPlotLeft + kPlotWidth / 2, bottom + 42, "middle", plot_.x_label,
                  " style=\"fill:var(--soft,#68717c)\"") +
           textAt(15, middle, "middle", plot_.y_label, turned.c_str());
  }

  std::string curve(size_t index) const {
    std::string path, markers, out;
    bool pen_down = false;
    for (const auto& p : plot_.curves[index].points) {
      if (!drawable(plot_, p)) {
        pen_down = false;
        continue;
      }
      path += printed("%c%.2f %.2f", pen_down ? 'L' : 'M', px(p.first), py(p.second));
      markers += marker(index, px(p.first), py(p.second)) + "\n";
      pen_down = true;
    }
    if (path.empty()) return {};
    return "<path d=\"" + path + "\" style=\"fill:none;stroke:" + colour(index) + ";stroke-width:2" + dash(index) +
           "\"/>\n" + markers;
  }

  struct Legend {
    std::string svg;
    int rows = 0;
  };
  Legend legendAt(double y) const {
    std::string out;
    double x = kPlotLeft;
    int legend_rows = 1;
    for (size_t i = 0; i < plot_.curves.size(); ++i) {
      const std::string& name = plot_.curves[i].name;
      const double width = 52 + kLetter * static_cast<double>(name.size());
      if (x > kPlotLeft && x + width > kPlotLeft + kPlotWidth) x = kPlotLeft, y += kLegendRow, ++legend_rows;
      out += line(x, y - 4, x + 30, y - 4, ("stroke:" + colour(i) + ";stroke-width:2" + dash(i)).c_str());
      out += marker(i, x + 15, y - 4) + textAt(x + 37, y, "start", name);
      x += width;
    }
    return {out, legend_rows};
  }

  const Plot& plot_;
  bool empty_ = true;
  Axis x_, y_;
};

}  // namespace

double Axis::share(double value) const {
  if (log) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

Axis makeAxis(const std::vector<double>& values, bool log, bool own_ticks) {
  Axis axis;
  axis.log = log;
  if (values.empty()) {
    if (log) axis.low = 1, axis.high = 10;
    axis.ticks = {axis.low, axis.high};
    return axis;
  }
  std::vector<double> different(values);
  std::sort(different.begin(), different.end());
  different.erase(std::unique(different.begin(), different.end()), different.end());
  axis.low = different.front(), axis.high = different.back();
  if (log && own_ticks && different.size() > 1 && different.size() <= 8) {
    axis.ticks = different;
  } else if (log) {
    logTicks(axis);
  } else {
    linearTicks(axis);
  }
  return axis;
}

std::string plotSvg(const Plot& plot) { return Drawing(plot).svg(); }

}  // namespace fourdvt::report
