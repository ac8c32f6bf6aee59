// SPDX-License-Identifier: Apache-2.0
// Marching squares, the plane case of LC87. A sample is a pixel's centre; a frame of performer samples surrounds the
// picture. A cell has the samples' corners 0…3 clockwise from the top left, and its side k runs from corner k to corner
// k + 1.
#include "silhouette/contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace fourdvt::silhouette {
namespace {

constexpr double kContourLevel = 127.5;
constexpr uint8_t kPerformer = 128;   // the least value above the level
constexpr double kLeastShare = 0.02;  // of a cell's side, between a ring and a sample: keeps rings apart
constexpr int kCornerX[4] = {0, 1, 1, 0}, kCornerY[4] = {0, 0, 1, 1};
constexpr int kBeyondX[4] = {0, 1, 0, -1}, kBeyondY[4] = {-1, 0, 1, 0};  // the cell on the other side of side k

// Whether eight samples are all the performer's, or all background.
bool sameForEight(const uint8_t* samples, bool performer) {
  constexpr uint64_t kTopBits = 0x8080808080808080;  // set from kPerformer on
  uint64_t eight;
  std::memcpy(&eight, samples, sizeof eight);
  return (eight & kTopBits) == (performer ? kTopBits : 0);
}

class Tracer {
 public:
  Tracer(const Image& coverage, int steps_per_px)
      : coverage_(coverage), steps_(steps_per_px), visited_(size_t(coverage.width + 1) * (coverage.height + 2), 0) {}

  std::vector<Ring> rings() {
    std::vector<Ring> all;
    for (int y = 0; y < coverage_.height; ++y) {
      const uint8_t* row = coverage_.at(0, y);
      bool before = true;  // performer, as outside of the picture
      for (int x = 0; x <= coverage_.width; ++x) {
        while (x + 8 <= coverage_.width && sameForEight(row + x, before)) x += 8;
        const bool here = x == coverage_.width || row[x] >= kPerformer;
        if (here != before && !visited(x - 1, y)) all.push_back(trace(x - 1, y));
        before = here;
      }
    }
    return all;
  }

 private:
  int sample(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < coverage_.width && y < coverage_.height;
    return inside ? *coverage_.at(x, y) : 255;
  }
  bool performer(int x, int y) const { return sample(x, y) >= kPerformer; }
  uint8_t& visited(int x, int y) { return visited_[size_t(y + 1) * (coverage_.width + 1) + x + 1]; }

  // The ring through the side between samples (x, y) and (x + 1, y).
  Ring trace(int x, int y) {
    // It enters the cell in which its side, clockwise, runs from background to performer.
    const bool below = !performer(x, y);
    int cell_y = below ? y : y - 1, cell_x = x, side = below ? 0 : 2;
    Ring ring;
    while (true) {
      if (side == 0 || side == 2) {
        uint8_t& seen = visited(cell_x, cell_y + (side == 2));
        if (seen) break;
        seen = 1;
      }
      ring.push_back(crossing(cell_x, cell_y, side));
      const int exit = exitOf(cell_x, cell_y, side);
      if (pictureCorner(cell_x, cell_y)) {
        const glm::dvec2 in = ring.back(), out = crossing(cell_x, cell_y, exit);
        ring.push_back(side % 2 == 0 ? glm::dvec2(in.x, out.y) : glm::dvec2(out.x, in.y));
      }
      cell_x += kBeyondX[exit];
      cell_y += kBeyondY[exit];
      side = (exit + 2) % 4;
    }
    return ring;
  }

  // Here a ring turns at a right angle, so that the picture's border stays straight.
  bool pictureCorner(int x, int y) const {
    return (x == -1 || x == coverage_.width - 1) && (y == -1 || y == coverage_.height - 1);
  }

  // A ring that enters at side k has background at corner k and the performer at corner k + 1.
  int exitOf(int x, int y, int entry) const {
    std::array<int, 4> value;
    for (int k = 0; k < 4; ++k) value[k] = sample(x + kCornerX[k], y + kCornerY[k]);
    const auto inside = [&](int k) { return value[k % 4] >= kPerformer; };
    const bool saddle = !inside(entry + 2) && inside(entry + 3);
    // At a saddle the cell's mean says which of the two is connected.
    if (saddle && value[0] + value[1] + value[2] + value[3] > 4 * kContourLevel) return (entry + 3) % 4;
    int exit = entry + 1;
    while (inside(exit + 1)) ++exit;
    return exit % 4;
  }

  glm::dvec2 crossing(int x, int y, int side) const {
    const int next = (side + 1) % 4;
    const int x0 = x + kCornerX[side], y0 = y + kCornerY[side], x1 = x + kCornerX[next], y1 = y + kCornerY[next];
    const double v0 = sample(x0, y0), v1 = sample(x1, y1);
    const double share = crossingShare((kContourLevel - v0) / (v1 - v0));
    return {x0 + 0.5 + share * (x1 - x0), y0 + 0.5 + share * (y1 - y0)};
  }

  // Samples lie on the steps, so that a crossing does where its share is a multiple of them.
  double crossingShare(double share) const {
    if (steps_ == 0) return std::clamp(share, kLeastShare, 1 - kLeastShare);
    return std::clamp(std::round(share * steps_), 1.0, steps_ - 1.0) / steps_;
  }

  const Image& coverage_;
  const int steps_;
  std::vector<uint8_t> visited_;  // of the sides between horizontal neighbours: every ring crosses one
};

}  // namespace

Outline outlineOf(const Image& coverage, const OutlineRules& rules) {
  if (coverage.empty() || coverage.channels != 1) return {};
  Outline outline{Tracer(coverage, rules.steps_per_px).rings()};
  std::erase_if(outline.rings, [&](const Ring& ring) {
    return ring.size() < 3 || std::abs(signedArea_px2(ring)) < rules.min_area_px2;
  });
  if (rules.tolerance_px > 0) simplifyRings(outline.rings, rules.tolerance_px);
  return outline;
}

}  // namespace fourdvt::silhouette
