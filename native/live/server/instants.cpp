// SPDX-License-Identifier: Apache-2.0
#include "live/server/instants.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/robust.h"

namespace fourdvt::live {
namespace {

constexpr double kKeepsSlot = 0.65;           // slots: hysteresis of a camera whose captures lie between two slots
constexpr int64_t kAhead_us = 500'000;        // pictures farther in the future are rejected
constexpr int64_t kClockBack_us = 2'000'000;  // threshold for detecting that the server's own clock was set back
constexpr int kSlow = 8;  // consecutive late pictures after which the camera is no longer waited for

}  // namespace

size_t Instant::count() const {
  return size_t(std::count_if(pictures.begin(), pictures.end(), [](const auto& p) { return p != nullptr; }));
}

Instants::Instants(const InstantRules& rules)
    : rules_(rules),
      period_us_(1e6 / rules.fps),
      max_slots_(size_t(std::max(8.0, std::ceil(rules.wait_s * rules.fps) + 4))),
      cameras_(rules.cameras) {}

void Instants::setConnected(size_t camera, bool connected, int64_t now_us) {
  Camera fresh;
  fresh.connected = connected;
  fresh.came_us = now_us;
  fresh.late = cameras_[camera].late;
  cameras_[camera] = fresh;
}

bool Instants::lost(size_t camera, int64_t now_us) const {
  const Camera& c = cameras_[camera];
  return c.connected && double(now_us - c.came_us) > 1e6 * rules_.lost_s;
}

bool Instants::waitedFor(size_t camera, int64_t now_us) const {
  return cameras_[camera].connected && !lost(camera, now_us) && cameras_[camera].slow < kSlow;
}

int64_t Instants::timeOf(int64_t slot) const { return std::llround(double(slot) * period_us_); }

// Nearest slot; or the successor of the camera's last slot if captures lie steadily between two slots.
int64_t Instants::slotOf(Camera& camera, int64_t captured_us) const {
  const double at = double(captured_us) / period_us_;
  int64_t slot = std::llround(at);
  if (camera.seen) {
    const int64_t next = camera.slot + std::llround(double(captured_us - camera.time_us) / period_us_);
    if (std::abs(at - double(next)) < kKeepsSlot) slot = next;
  }
  camera.slot = slot;
  camera.time_us = captured_us;
  return slot;
}

void Instants::begin(int64_t now_us) {
  if (closed_ == INT64_MIN || timeOf(closed_) < now_us + kClockBack_us) return;
  slots_.clear();
  closed_ = INT64_MIN;
}

bool Instants::add(size_t camera, std::shared_ptr<const TimedPicture> picture, int64_t now_us) {
  begin(now_us);
  Camera& c = cameras_[camera];
  const int64_t captured_us = picture->captured_us;
  const bool believed = captured_us <= now_us + kAhead_us && captured_us > now_us - kAhead_us * 60;
  const int64_t slot = believed ? slotOf(c, captured_us) : INT64_MIN;
  c.seen = true;
  c.came_us = now_us;
  c.slow = double(now_us - captured_us) > 1e6 * rules_.wait_s ? std::min(c.slow + 1, kSlow) : 0;
  if (!believed || slot <= closed_) {
    ++c.late;
    return false;
  }
  Slot& at = slots_[slot];
  at.resize(cameras_.size());
  const auto away = [&](const TimedPicture& p) { return std::abs(p.captured_us - timeOf(slot)); };
  if (!at[camera] || away(*picture) < away(*at[camera])) at[camera] = std::move(picture);
  if (slots_.size() > max_slots_) {  // take() has fallen behind
    closed_ = slots_.begin()->first;
    slots_.erase(slots_.begin());
    ++skipped_;
  }
  return slot > closed_;
}

bool Instants::complete(const Slot& slot, int64_t now_us) const {
  for (size_t c = 0; c < cameras_.size(); ++c)
    if (!slot[c] && waitedFor(c, now_us)) return false;
  return true;
}

Instant Instants::made(int64_t number, const Slot& slot, bool complete) const {
  Instant out{number, 0, slot, complete};
  int64_t sum_us = 0;  // sum of differences
  for (const auto& p : slot)
    if (p) sum_us += p->captured_us - timeOf(number);
  out.captured_us = timeOf(number) + sum_us / int64_t(std::max<size_t>(out.count(), 1));
  return out;
}

std::optional<Instants::Taken> Instants::take(int64_t now_us) {
  begin(now_us);
  const auto overdue = [&](int64_t slot) { return double(now_us - timeOf(slot)) >= 1e6 * rules_.wait_s; };
  const auto enough = [&](const Slot& slot) {
    return size_t(std::count(slot.begin(), slot.end(), nullptr)) + kMinPictures <= slot.size();
  };
  auto newest = slots_.end();
  for (auto it = slots_.begin(); it != slots_.end(); ++it)
    if (enough(it->second) && (overdue(it->first) || complete(it->second, now_us))) newest = it;
  std::optional<Taken> out;
  if (newest != slots_.end()) {
    out.emplace();
    for (auto it = slots_.begin(); it != newest; ++it) {
      const bool whole = complete(it->second, now_us);
      enough(it->second) ? ++skipped_ : ++too_few_;
      if (whole && enough(it->second)) out->skipped.push_back(made(it->first, it->second, true));
    }
    out->instant = made(newest->first, newest->second, complete(newest->second, now_us));
    closed_ = newest->first;
    slots_.erase(slots_.begin(), std::next(newest));
  }
  while (!slots_.empty() && overdue(slots_.begin()->first)) {  // too few pictures
    closed_ = slots_.begin()->first;
    slots_.erase(slots_.begin());
    ++too_few_;
  }
  return out;
}

std::optional<int64_t> Instants::due_us() const {
  if (slots_.empty()) return std::nullopt;
  return timeOf(slots_.begin()->first) + std::llround(1e6 * rules_.wait_s);
}

namespace {

constexpr size_t kAnswers = 16, kDeciding = 4;
constexpr int64_t kMuchLonger_us = 2000;  // margin over the shortest round trip beyond which an answer is ignored

}  // namespace

void ClockOffset::add(const ClockAnswer& answer, int64_t now_us) {
  if (std::max(std::abs(answer.camera_us), std::abs(now_us)) > kLatest_us) return;
  if (answer.server_us > now_us || answer.server_us < now_us - kMaxRoundTrip_us) return;
  const int64_t round_trip_us = now_us - answer.server_us;
  const Answer next{round_trip_us, answer.camera_us - (answer.server_us + round_trip_us / 2)};
  // The true offset deviates from an answer's by at most half of the round trip.
  if (known() && std::abs(next.offset_us - offset_us_) > kJump_us + round_trip_us / 2) answers_.clear();
  answers_.push_back(next);
  if (answers_.size() > kAnswers) answers_.pop_front();
  decide();
}

void ClockOffset::decide() {
  std::vector<Answer> sorted(answers_.begin(), answers_.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Answer& a, const Answer& b) { return a.round_trip_us < b.round_trip_us; });
  const int64_t base_us = sorted[0].offset_us, longest_us = sorted[0].round_trip_us + kMuchLonger_us;
  int64_t sum_us = 0, count = 0;  // sum of differences, since offsets themselves may be large
  for (size_t i = 0; i < std::min(kDeciding, sorted.size()) && sorted[i].round_trip_us <= longest_us; ++i, ++count)
    sum_us += sorted[i].offset_us - base_us;
  offset_us_ = base_us + sum_us / count;
}

namespace {

constexpr int64_t kReaches_us = 200'000;           // delay until a new tolerance shows in the cameras' outlines
constexpr double kTooBusy = 1.1, kTooIdle = 0.85;  // multiples of the hull's share between which the tolerance is kept
constexpr double kMaxRise = 1.8, kMaxFall = 0.93;  // maximum factors per step
constexpr double kRisePower = 0.9, kFallPower = 0.3;  // exponents on the ratio to the target share
constexpr size_t kMaxRatios = 1000;

}  // namespace

ToleranceControl::ToleranceControl(const ToleranceRules& rules, double first_px)
    : rules_(rules), tolerance_px_(std::clamp(first_px, rules.min_px, rules.max_px)) {}

bool ToleranceControl::add(int64_t now_us, double hull_busy, double other_busy) {
  if (!began_ || now_us < stepped_us_) began_ = true, stepped_us_ = now_us;
  const double hull_share = std::max(rules_.busy_share - other_busy, rules_.min_hull_share);
  if (now_us - stepped_us_ >= kReaches_us && ratios_.size() < kMaxRatios) ratios_.push_back(hull_busy / hull_share);
  if (now_us - stepped_us_ < kStep_us || ratios_.empty()) return false;
  const double ratio = median(ratios_);
  double factor = 1;
  if (ratio > kTooBusy) factor = std::min(std::pow(ratio, kRisePower), kMaxRise);
  if (ratio < kTooIdle) factor = std::max(std::pow(std::max(ratio, 1e-3), kFallPower), kMaxFall);
  const double next_px = std::clamp(tolerance_px_ * factor, rules_.min_px, rules_.max_px);
  stepped_us_ = now_us;
  ratios_.clear();
  if (next_px == tolerance_px_) return false;
  tolerance_px_ = next_px;
  return true;
}

}  // namespace fourdvt::live
