// SPDX-License-Identifier: Apache-2.0
#include "player/parts/ladder.h"

#include <algorithm>
#include <cmath>

namespace fourdvt {

namespace {

constexpr double kHalfLife_s = 3;   // decay of measurements, in fetching time
constexpr double kSoonest_s = 0.2;  // fetching time before the first estimate
constexpr double kExpected_s = 1;   // weight of an expected throughput, in measuring time
constexpr double kUp = 0.7,
                 kKeep = 0.9;              // throughput shares for stepping up to a rendition, and for keeping it
constexpr double kPlenty_s = 4, kTry = 2;  // buffer ahead, and throughput share, for trying a rendition
constexpr double kLateHalfLife_s = 3;      // decay of late time
constexpr double kTooLate_s = 0.4;         // steady-state late time of a decoder that is late a tenth of the time
constexpr double kLongStep_s = 0.1;        // page was busy or suspended
constexpr double kRest_s = 30;             // first pause before a too slow rendition is retried

double bitsPerSecond(const package::Sequence& s, uint32_t rendition) {
  return 8 * double(s.renditions[rendition].video_bytes + s.geometryBytes(rendition)) / s.duration_s();
}

uint32_t texelsOf(const package::Rendition& r) {
  return uint32_t(r.layers.empty() ? r.tiles.width : r.layers[0].width);
}

}  // namespace

Ladder::Ladder(uint32_t quality) : quality_(quality), slow_s_(kRest_s) {}

void Ladder::setQuality(uint32_t quality, uint32_t max_texels) {
  quality_ = quality;
  max_texels_ = max_texels;
}

bool Ladder::leaveOut(const package::Sequence& s, uint32_t rendition) {
  left_out_ |= 1u << rendition;
  return !allOut(s);
}

void Ladder::seekAgain(const package::Sequence& s) {
  for (const package::Rendition& r : s.renditions) std::erase(missing_, &r);
}

bool Ladder::tooSlow(const package::Sequence& s, uint32_t r) const {
  return quality_ == kAutomaticRendition && r > 0 &&
         ((too_slow_ && r >= too_slow_) || std::find(rough_.begin(), rough_.end(), &s.renditions[r]) != rough_.end());
}

void Ladder::judge(const package::Sequence& s, uint32_t rendition, bool plays) {
  std::vector<const package::Rendition*>& list = plays ? rough_ : missing_;
  list.push_back(&s.renditions[rendition]);
  if (allOut(s)) list.pop_back();
}

bool Ladder::isOut(const package::Sequence& s, uint32_t r) const {
  return (left_out_ >> r & 1) != 0 || std::find(missing_.begin(), missing_.end(), &s.renditions[r]) != missing_.end();
}

bool Ladder::allOut(const package::Sequence& s) const {
  for (uint32_t r = 0; r < s.renditions.size(); ++r)
    if (!isOut(s, r)) return false;
  return true;
}

uint32_t Ladder::allowed(const package::Sequence& s, uint32_t r) const {
  uint32_t found = r;
  while (found > 0 && isOut(s, found)) --found;
  while (isOut(s, found) && found + 1 < s.renditions.size()) ++found;
  return found;
}

void Ladder::expect(double throughput_bps) {
  seconds_ = kExpected_s;
  bytes_ = throughput_bps / 8 * kExpected_s;
}

void Ladder::measure(uint64_t bytes, double step_s, bool fetching) {
  slow_left_s_ -= step_s;
  rest_left_s_ -= step_s;
  if (slow_left_s_ <= 0) too_slow_ = 0;
  bytes_ += double(bytes);
  if (!fetching) return;
  seconds_ += step_s;
  const double kept = std::exp2(-step_s / kHalfLife_s);
  bytes_ *= kept;
  seconds_ *= kept;
}

void Ladder::measureDecoding(uint32_t rendition, double step_s, bool late) {
  if (!rendition || step_s > kLongStep_s || (too_slow_ && rendition >= too_slow_)) return;
  late_s_ = late_s_ * std::exp2(-step_s / kLateHalfLife_s) + (late ? step_s : 0);
  if (late_s_ < kTooLate_s) return;
  late_s_ = 0;
  too_slow_ = rendition;
  slow_left_s_ = slow_s_;
  slow_s_ *= 2;
}

uint32_t Ladder::highest(const package::Sequence& s) const {
  const uint32_t top = uint32_t(s.renditions.size()) - 1;
  if (quality_ != kAutomaticRendition) return allowed(s, std::min(quality_, top));
  uint32_t r = top;
  while (r > 0 && (tooSlow(s, r) || (max_texels_ > 0 && texelsOf(s.renditions[r]) > max_texels_))) --r;
  return allowed(s, r);
}

uint32_t Ladder::choose(const package::Sequence& s, uint32_t present, double ahead_s) const {
  uint32_t r = highest(s);
  if (quality_ != kAutomaticRendition) return r;
  const double carried_bps = seconds_ < kSoonest_s ? 0 : throughput_bps();
  const bool plenty = ahead_s >= kPlenty_s;
  const auto share = [&](uint32_t n) {
    if (n <= present) return plenty ? HUGE_VAL : kKeep;
    return plenty && n == present + 1 && rest_left_s_ <= 0 ? kTry : kUp;
  };
  while (r > 0 && bitsPerSecond(s, r) > carried_bps * share(r)) --r;
  return allowed(s, r);
}

}  // namespace fourdvt
