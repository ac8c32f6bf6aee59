// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/sweep_cells.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kPositionError_px = 1, kNearest_m = 1e-3;

// Cells behind one kSweepCell × kSweepCell square of the reference, in one camera.
class Column {
 public:
  Column(const SweptCamera& camera, const glm::dvec2& low, const glm::dvec2& high)
      : matte_(*camera.matte), start_(camera.pixel_from_reference[3]) {
    for (int k = 0; k < 4; ++k)
      rays_[k] =
          glm::dvec3(camera.pixel_from_reference * glm::dvec4(k & 1 ? high.x : low.x, k >> 1 ? high.y : low.y, 1, 0));
  }
  // True if the camera sees only background behind the cell between the two depths.
  bool outside(double near_m, double far_m) const {
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::dvec3& ray : rays_)
      for (const double depth : {near_m, far_m}) {
        const glm::dvec3 q = ray * depth + start_;
        if (q.z < kNearest_m) return false;
        low = glm::min(low, glm::dvec2(q) / q.z), high = glm::max(high, glm::dvec2(q) / q.z);
      }
    return matte_.onlyBackground(low, high);
  }

 private:
  const MatteCounts& matte_;
  glm::dvec3 start_;
  std::array<glm::dvec3, 4> rays_;
};

}  // namespace

MatteCounts::MatteCounts(const Image& rgba, uint8_t background) : width_(rgba.width), height_(rgba.height) {
  counts_.assign(size_t(width_ + 1) * (height_ + 1), 0);
  for (int y = 0; y < height_; ++y) {
    uint32_t row = 0;
    for (int x = 0; x < width_; ++x) {
      row += rgba.at(x, y)[3] >= background;
      counts_[index(x + 1, y + 1)] = counts_[index(x + 1, y)] + row;
    }
  }
}

bool MatteCounts::onlyBackground(const glm::dvec2& low, const glm::dvec2& high) const {
  const glm::dvec2 first = low - 0.5 - kPositionError_px, last = high - 0.5 + kPositionError_px;
  if (!(first.x >= 0 && first.y >= 0 && last.x <= width_ - 1 && last.y <= height_ - 1)) return false;
  const int x0 = int(first.x), y0 = int(first.y), x1 = std::min(int(last.x) + 2, width_),
            y1 = std::min(int(last.y) + 2, height_);
  return counts_[index(x1, y1)] + counts_[index(x0, y0)] == counts_[index(x0, y1)] + counts_[index(x1, y0)];
}

std::vector<uint8_t> openCells(std::span<const SweptCamera> cameras, const PictureRegion& region,
                               std::span<const int> first_plane, int blocks, double step_m) {
  const int across = (region.width + kSweepCell - 1) / kSweepCell, down = (region.height + kSweepCell - 1) / kSweepCell;
  std::vector<uint8_t> open(size_t(across) * down * blocks, 0);
  inParallel(size_t(across) * down, [&](size_t cell) {
    const int x0 = int(cell) % across * kSweepCell, y0 = int(cell) / across * kSweepCell,
              x1 = std::min(x0 + kSweepCell, region.width), y1 = std::min(y0 + kSweepCell, region.height);
    int first = std::numeric_limits<int>::max(), last = -1;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const int plane = first_plane[size_t(y) * region.width + x];
        if (plane >= 0) first = std::min(first, plane), last = std::max(last, plane);
      }
    if (last < 0) return;
    std::vector<Column> columns;
    for (const SweptCamera& camera : cameras)
      columns.emplace_back(camera, glm::dvec2(region.x + x0, region.y + y0), glm::dvec2(region.x + x1, region.y + y1));
    for (int b = 0; b < blocks; ++b) {
      const double near_m = (first + 4 * b - 1) * step_m, far_m = (last + 4 * b + 4) * step_m;  // a plane to spare
      const auto outside = [&](const Column& column) { return column.outside(near_m, far_m); };
      open[size_t(b) * across * down + cell] = std::none_of(columns.begin(), columns.end(), outside) ? 255 : 0;
    }
  });
  return open;
}

}  // namespace fourdvt::reconstruct
