// SPDX-License-Identifier: Apache-2.0
// Moves the tolerance of outlines such that the work for a frame takes a wanted share of the frame's time: up at once,
// down slowly. Work that the tolerance does not change leaves the hull at least a share of its own, since a coarser
// hull would not make it cheaper. Does NOT measure times.
#pragma once

#include <cstdint>
#include <vector>

namespace fourdvt::live {

struct ToleranceRules {
  double least_px = 0.5, most_px = 16;
  double busy_share = 0.75;
  double least_hull_share = 0.15;  // of the frame's time, for the hull
};

class ToleranceControl {
 public:
  explicit ToleranceControl(const ToleranceRules& rules, double first_px = 1);
  // A frame's work over the frame's time: hull, and all else. True when the tolerance was changed: at most every
  // kStep_us.
  bool add(int64_t now_us, double hull_busy, double other_busy);
  double tolerance_px() const { return tolerance_px_; }

  static constexpr int64_t kStep_us = 500'000;

 private:
  ToleranceRules rules_;
  double tolerance_px_;
  bool began_ = false;
  int64_t stepped_us_ = 0;
  std::vector<double> ratios_;  // of the hull's work to its share, since the last step has reached the cameras
};

}  // namespace fourdvt::live
