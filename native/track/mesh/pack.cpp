// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/pack.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "track/mesh/bit_grid.h"

namespace fourdvt::track {
namespace {

constexpr int kCoarseCells = 256, kFineCells = 512;  // most cells along a side
constexpr int kCoarseSteps = 8, kFineSteps = 5;
constexpr int kShuffles = 12;     // orders tried at a scale, besides those by size
constexpr double kShuffle = 1.0;  // largest random enlargement of a chart's size in an order
constexpr double kMaxCovered = 0.95, kFinestGain = 1.1;
constexpr int kTurns = 4;
constexpr double kPi = 3.14159265358979;

glm::dvec2 turned(const glm::dvec2& p, double angle) {
  return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y};
}

struct Box {
  glm::dvec2 low{1e300}, high{-1e300};
};

Box boxOf(const PackedChart& chart, double angle) {
  Box box;
  for (const uint32_t v : chart.border) {
    const glm::dvec2 p = turned(chart.points[v], angle);
    box.low = glm::min(box.low, p);
    box.high = glm::max(box.high, p);
  }
  return box;
}

// Angle at which the chart's box is smallest and lies flat.
double restingAngle(const PackedChart& chart) {
  double best = 0, least = 1e300;
  for (int degree = 0; degree < 180; ++degree) {
    const Box box = boxOf(chart, degree * kPi / 180);
    const glm::dvec2 size = box.high - box.low;
    if (size.x >= size.y && size.x * size.y < least) least = size.x * size.y, best = degree * kPi / 180;
  }
  return best;
}

double areaOf(const PackedChart& chart) {
  double twice = 0;
  for (size_t i = 0; i < chart.border.size(); ++i) {
    const glm::dvec2 a = chart.points[chart.border[i]], b = chart.points[chart.border[(i + 1) % chart.border.size()]];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

double distanceToSegment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ab = b - a;
  const double size = glm::dot(ab, ab), t = size > 0 ? std::clamp(glm::dot(p - a, ab) / size, 0.0, 1.0) : 0;
  return glm::length(p - a - t * ab);
}

// The cells closer than `reach` to the chart whose outline, in cells, is given.
Mask maskOf(const std::vector<glm::dvec2>& outline, double reach) {
  Box box;
  for (const glm::dvec2& p : outline) box.low = glm::min(box.low, p), box.high = glm::max(box.high, p);
  Mask mask(int(std::ceil(box.high.x + reach)), int(std::ceil(box.high.y + reach)));
  std::vector<std::vector<double>> crossings(size_t(mask.height()));
  for (size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    const glm::ivec2 low = glm::floor(glm::min(a, b) - reach), high = glm::floor(glm::max(a, b) + reach);
    for (int y = std::max(0, low.y); y <= std::min(mask.height() - 1, high.y); ++y) {
      const double middle = y + 0.5;
      if ((a.y <= middle) != (b.y <= middle))
        crossings[size_t(y)].push_back(a.x + (middle - a.y) / (b.y - a.y) * (b.x - a.x));
      for (int x = std::max(0, low.x); x <= std::min(mask.width() - 1, high.x); ++x) {
        const auto near = [&](const glm::dvec2& end) {
          const glm::dvec2 inside = glm::clamp(end, glm::dvec2(x, y), glm::dvec2(x + 1, y + 1));
          return glm::length(end - inside) < reach;
        };
        bool close = near(a) || near(b);
        for (int corner = 0; corner < 4 && !close; ++corner)
          close = distanceToSegment(glm::dvec2(x + corner % 2, y + corner / 2), a, b) < reach;
        if (close) mask.set(x, y);
      }
    }
  }
  for (int y = 0; y < mask.height(); ++y) {
    std::vector<double>& row = crossings[size_t(y)];
    std::sort(row.begin(), row.end());
    for (size_t i = 0; i + 1 < row.size(); i += 2)
      for (int x = std::max(0, int(std::ceil(row[i] - 0.5))); x < mask.width() && x + 0.5 <= row[i + 1]; ++x)
        mask.set(x, y);
  }
  mask.finish();
  return mask;
}

struct Place {
  double angle = 0, scale = 0;
  glm::dvec2 offset{0};  // texels, added after turning and scaling
};

class Packer {
 public:
  Packer(const std::vector<PackedChart>& charts, int texels, int gutter_texels)
      : charts_(charts), texels_(texels), gutter_(gutter_texels) {
    for (const PackedChart& chart : charts_) {
      angles_.push_back(restingAngle(chart));
      const Box box = boxOf(chart, angles_.back());
      spans_.push_back(box.high.x - box.low.x);
      areas_.push_back(areaOf(chart));
    }
  }

  bool run() {
    const double most = texels_ * std::sqrt(kMaxCovered / std::accumulate(areas_.begin(), areas_.end(), 1e-300));
    double scale = search(kCoarseCells, 0, most, kCoarseSteps, 0);
    scale = search(kFineCells, scale, std::min(most, kFinestGain * scale), kFineSteps, kShuffles);
    return scale > 0;
  }

  const std::vector<Place>& places() const { return places_; }

 private:
  // Returns the largest scale found above `low`, or `low`.
  double search(int cells, double low, double high, int steps, int shuffles) {
    for (int i = 0; i < steps; ++i) {
      const double scale = 0.5 * (low + high);
      (tryScale(cells, scale, shuffles) ? low : high) = scale;
    }
    return low;
  }

  bool tryScale(int cells, double scale, int shuffles) {
    const int cell = std::max(1, (texels_ + cells - 1) / cells);
    std::vector<std::vector<Mask>> masks;
    for (size_t c = 0; c < charts_.size(); ++c) {
      masks.emplace_back();
      for (int turn = 0; turn < kTurns; ++turn)
        masks[c].push_back(maskOf(outlineIn(c, turn, scale, cell), reach(cell)));
    }
    if (placeAll(masks, ordered(areas_), scale, cell) || placeAll(masks, ordered(spans_), scale, cell)) return true;
    std::minstd_rand random(1);
    for (int i = 0; i < shuffles; ++i) {
      std::vector<double> sizes = areas_;
      for (double& size : sizes) size *= 1 + kShuffle * double(random() - random.min()) / double(random.max());
      if (placeAll(masks, ordered(sizes), scale, cell)) return true;
    }
    return false;
  }

  double reach(int cell) const { return std::max(gutter_ / 2.0 / cell, 0.71); }
  double angleOf(size_t chart, int turn) const { return angles_[chart] + turn * (2 * kPi / kTurns); }
  glm::dvec2 startOf(size_t chart, int turn, double scale, int cell) const {
    return reach(cell) * cell - scale * boxOf(charts_[chart], angleOf(chart, turn)).low;
  }

  std::vector<glm::dvec2> outlineIn(size_t chart, int turn, double scale, int cell) const {
    const double angle = angleOf(chart, turn);
    const glm::dvec2 start = startOf(chart, turn, scale, cell);
    std::vector<glm::dvec2> outline;
    for (const uint32_t v : charts_[chart].border)
      outline.push_back((scale * turned(charts_[chart].points[v], angle) + start) / double(cell));
    return outline;
  }

  static std::vector<size_t> ordered(const std::vector<double>& sizes) {
    std::vector<size_t> order(sizes.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return sizes[a] > sizes[b]; });
    return order;
  }

  bool placeAll(const std::vector<std::vector<Mask>>& masks, const std::vector<size_t>& order, double scale, int cell) {
    BitGrid grid(texels_ / cell);
    std::vector<Place> places(charts_.size());
    for (const size_t c : order) {
      int best_turn = -1;
      glm::ivec2 best(0);
      const auto rank = [&](int turn, const glm::ivec2& at) {
        return std::pair{at.y + masks[c][size_t(turn)].height(), at.x};
      };
      for (int turn = 0; turn < kTurns; ++turn)
        if (const auto at = grid.firstFree(masks[c][size_t(turn)]))
          if (best_turn < 0 || rank(turn, *at) < rank(best_turn, best)) best_turn = turn, best = *at;
      if (best_turn < 0) return false;
      grid.occupy(masks[c][size_t(best_turn)], best);
      places[c] = {angleOf(c, best_turn), scale, startOf(c, best_turn, scale, cell) + double(cell) * glm::dvec2(best)};
    }
    places_ = std::move(places);
    return true;
  }

  const std::vector<PackedChart>& charts_;
  const int texels_, gutter_;
  std::vector<double> angles_, spans_, areas_;  // [chart] at rest; along x; square units
  std::vector<Place> places_;                   // [chart] of the largest scale so far
};

}  // namespace

bool pack(std::vector<PackedChart>& charts, int texels, int gutter_texels) {
  Packer packer(charts, texels, gutter_texels);
  if (!packer.run()) return false;
  for (size_t c = 0; c < charts.size(); ++c)
    for (glm::dvec2& p : charts[c].points)
      p = packer.places()[c].scale * turned(p, packer.places()[c].angle) + packer.places()[c].offset;
  return true;
}

}  // namespace fourdvt::track
