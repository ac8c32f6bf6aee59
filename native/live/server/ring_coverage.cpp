// SPDX-License-Identifier: Apache-2.0
#include "live/server/ring_coverage.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::live {

// Within one row of pixels an edge runs from x0 to x1 and covers `height` of the row (negative: upwards): adds to every
// pixel the change of the area right of the edge.
void RingCoverage::addRow(int y, double x0, double x1, double height) {
  float* row = &area_[size_t(y) * (width_ + 1)];
  x0 = std::clamp(x0, 0.0, double(width_));
  x1 = std::clamp(x1, 0.0, double(width_));
  if (x0 > x1) std::swap(x0, x1);
  const int first = std::min(int(x0), width_), last = std::min(int(x1), width_);
  if (first == last) {
    const double right = first + 1 - (x0 + x1) / 2;
    row[first] += float(height * right);
    if (first < width_) row[first + 1] += float(height * (1 - right));
    return;
  }
  const double slope = height / (x1 - x0);
  double before = 0;  // area right of the edge within the pixels so far
  for (int x = first; x <= last; ++x) {
    const double from = std::max(x0, double(x)), to = std::min(x1, x + 1.0);
    const double passed = slope * (to - from), begun = slope * (from - x0);
    const double area = begun + passed * (x + 1 - (from + to) / 2);
    row[x] += float(area - before);
    before = area;
  }
  if (last < width_) row[last + 1] += float(height - before);
}

void RingCoverage::addEdge(double x0, double y0, double x1, double y1) {
  if (y0 == y1) return;
  const double sign = y0 < y1 ? 1 : -1;
  if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
  const double step = (x1 - x0) / (y1 - y0), end = std::min(y1, double(height_));
  for (double y = std::max(y0, 0.0); y < end;) {
    const int row = int(y);
    const double next = std::min(end, row + 1.0);
    addRow(row, x0 + (y - y0) * step, x0 + (next - y0) * step, sign * (next - y));
    y = next;
  }
}

const std::vector<float>& RingCoverage::draw(const std::vector<Ring16>& rings, const package::Rect& source,
                                             int stretched_width, int stretched_height, int width, int height) {
  width_ = width, height_ = height;
  area_.assign(size_t(width + 1) * height, 0);
  const double sx = double(stretched_width) / source.width, sy = double(stretched_height) / source.height;
  const auto x = [&](const Point16& p) { return (p.x / kPointsPerPixel - source.x) * sx; };
  const auto y = [&](const Point16& p) { return (p.y / kPointsPerPixel - source.y) * sy; };
  for (const Ring16& ring : rings)
    for (size_t i = 0; i < ring.size(); ++i) {
      const Point16 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      addEdge(x(a), y(a), x(b), y(b));
    }
  // Sums along rows, without their spare column. Downwards edges have the background on the left: negative.
  for (int row = 0; row < height; ++row) {
    const float* in = &area_[size_t(row) * (width + 1)];
    float* out = &area_[size_t(row) * width];
    float sum = 0;
    for (int k = 0; k < width; ++k) {
      sum += in[k];
      out[k] = std::clamp(std::abs(sum), 0.0f, 1.0f);
    }
  }
  area_.resize(size_t(width) * height);
  return area_;
}

}  // namespace fourdvt::live
