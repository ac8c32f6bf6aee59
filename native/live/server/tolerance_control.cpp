// SPDX-License-Identifier: Apache-2.0
#include "live/server/tolerance_control.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"

namespace fourdvt::live {
namespace {

constexpr int64_t kReaches_us = 200'000;              // from here to the cameras and back in outlines
constexpr double kTooBusy = 1.1, kTooIdle = 0.85;     // times the hull's share: nothing changes between them
constexpr double kMostRise = 1.8, kMostFall = 0.93;   // per step
constexpr double kRisePower = 0.9, kFallPower = 0.3;  // of the ratio to the wanted share
constexpr size_t kMostRatios = 1000;

}  // namespace

ToleranceControl::ToleranceControl(const ToleranceRules& rules, double first_px)
    : rules_(rules), tolerance_px_(std::clamp(first_px, rules.least_px, rules.most_px)) {}

bool ToleranceControl::add(int64_t now_us, double hull_busy, double other_busy) {
  if (!began_ || now_us < stepped_us_) began_ = true, stepped_us_ = now_us;
  const double hull_share = std::max(rules_.busy_share - other_busy, rules_.least_hull_share);
  if (now_us - stepped_us_ >= kReaches_us && ratios_.size() < kMostRatios) ratios_.push_back(hull_busy / hull_share);
  if (now_us - stepped_us_ < kStep_us || ratios_.empty()) return false;
  const double ratio = median(ratios_);
  double factor = 1;
  if (ratio > kTooBusy) factor = std::min(std::pow(ratio, kRisePower), kMostRise);
  if (ratio < kTooIdle) factor = std::max(std::pow(std::max(ratio, 1e-3), kFallPower), kMostFall);
  const double next_px = std::clamp(tolerance_px_ * factor, rules_.least_px, rules_.most_px);
  stepped_us_ = now_us;
  ratios_.clear();
  if (next_px == tolerance_px_) return false;
  tolerance_px_ = next_px;
  return true;
}

}  // namespace fourdvt::live
