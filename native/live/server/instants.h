// SPDX-License-Identifier: Apache-2.0
// Synchronisation of a live stage: groups pictures by instant (Instants), estimates clock offsets (ClockOffset), and
// controls the outlines' tolerance by the load (ToleranceControl). Single-threaded; times are passed in by the caller.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/robust.h"
#include "live/protocol/camera_messages.h"

namespace fourdvt::live {
struct InstantRules {
  size_t cameras = 0;
  double fps = 25;
  double wait_s = 0.1;  // time after an instant at which it is made from the pictures that have arrived
  double lost_s = 0.5;  // time without a picture after which a camera is no longer waited for
};

constexpr size_t kMinPictures = 2;  // minimum number of pictures for a hull

struct TimedPicture {
  CameraPicture picture;
  int64_t captured_us = 0;  // server's clock
};

struct Instant {
  int64_t slot = 0;                                           // strictly ascending
  int64_t captured_us = 0;                                    // mean of its pictures' capture times
  std::vector<std::shared_ptr<const TimedPicture>> pictures;  // per camera; null: none
  bool complete = false;                                      // true if no awaited camera is missing
  size_t count() const;
};

class Instants {
 public:
  explicit Instants(const InstantRules& rules);
  void setConnected(size_t camera, bool connected, int64_t now_us);
  // Adds a picture to the slot nearest to its capture time; slots are one frame long. False: it is late, or its time is
  // implausible. `now_us` and captured_us: server's clock.
  bool add(size_t camera, std::shared_ptr<const TimedPicture> picture, int64_t now_us);

  struct Taken {
    Instant instant;
    std::vector<Instant> skipped;  // older complete instants, ascending
  };
  // Newest instant that is due: all awaited cameras have a picture, or wait_s has passed. Older slots are closed.
  // Instants with fewer than kMinPictures pictures are dropped.
  std::optional<Taken> take(int64_t now_us);
  // Latest time at which the next instant falls due; none: no pictures are held.
  std::optional<int64_t> due_us() const;

  bool connected(size_t camera) const { return cameras_[camera].connected; }
  bool lost(size_t camera, int64_t now_us) const;  // connected, but no picture for lost_s
  uint64_t late(size_t camera) const { return cameras_[camera].late; }
  uint64_t skipped() const { return skipped_; }  // number of instants closed before they were taken
  uint64_t tooFew() const { return too_few_; }
  size_t held() const { return slots_.size(); }

 private:
  struct Camera {
    bool connected = false;
    bool seen = false;              // true after the first picture since it connected
    int64_t came_us = 0;            // arrival of its last picture, or time of connecting
    int64_t slot = 0, time_us = 0;  // slot and capture time of its last picture
    int slow = 0;                   // consecutive pictures that took longer than wait_s to arrive
    uint64_t late = 0;
  };
  using Slot = std::vector<std::shared_ptr<const TimedPicture>>;

  int64_t slotOf(Camera& camera, int64_t captured_us) const;
  int64_t timeOf(int64_t slot) const;
  bool waitedFor(size_t camera, int64_t now_us) const;
  bool complete(const Slot& slot, int64_t now_us) const;
  Instant made(int64_t number, const Slot& slot, bool complete) const;
  void begin(int64_t now_us);

  InstantRules rules_;
  double period_us_;
  size_t max_slots_;
  std::vector<Camera> cameras_;
  std::map<int64_t, Slot> slots_;  // every slot has at least one picture
  int64_t closed_ = INT64_MIN;     // slots up to this one are closed
  uint64_t skipped_ = 0, too_few_ = 0;
};

// Offset of a camera's clock from the server's, from questions and answers as in NTP: the mean over the recent answers
// with the shortest round trips.
class ClockOffset {
 public:
  // `now_us`: server's clock at the answer's arrival. Answers to impossible questions (from the future, or more than
  // kMaxRoundTrip_us ago) are ignored. A jump of the camera's clock by more than kJump_us restarts the estimate.
  void add(const ClockAnswer& answer, int64_t now_us);
  void reset() { answers_.clear(); }
  bool known() const { return !answers_.empty(); }
  int64_t offset_us() const { return offset_us_; }  // camera's clock minus server's; 0 before the first answer
  int64_t toServer(int64_t camera_us) const { return camera_us - offset_us_; }

  static constexpr int64_t kMaxRoundTrip_us = 5'000'000, kJump_us = 250'000;
  static constexpr int64_t kLatest_us = int64_t(1) << 60;  // limit of valid times

 private:
  struct Answer {
    int64_t round_trip_us, offset_us;
  };
  void decide();

  std::deque<Answer> answers_;
  int64_t offset_us_ = 0;
};

// Sliding window of values over the last second.
class Recent {
 public:
  void add(int64_t now_us, double value) {
    values_.push_back({now_us, value});
    forget(now_us);
  }
  double median(int64_t now_us) const {
    std::vector<double> values;
    for (const Value& v : values_)
      if (isRecent(v, now_us)) values.push_back(v.value);
    return fourdvt::median(std::move(values));
  }
  double sum(int64_t now_us) const {
    double out = 0;
    for (const Value& v : values_) out += isRecent(v, now_us) ? v.value : 0;
    return out;
  }

 private:
  struct Value {
    int64_t time_us;
    double value;
  };
  static constexpr int64_t kSecond_us = 1'000'000;
  static constexpr size_t kMax = 1000;

  static bool isRecent(const Value& v, int64_t now_us) {
    return v.time_us <= now_us && now_us - v.time_us < kSecond_us;
  }
  void forget(int64_t now_us) {
    while (!values_.empty() && (!isRecent(values_.front(), now_us) || values_.size() > kMax)) values_.pop_front();
  }

  std::deque<Value> values_;
};

// Limits and targets of ToleranceControl.
struct ToleranceRules {
  double min_px = 0.5, max_px = 16;
  double busy_share = 0.75;
  double min_hull_share = 0.15;  // minimum share of the frame's time for the hull
};

// Controls the tolerance of outlines such that the work for a frame takes a target share of the frame's time: raised
// immediately, lowered slowly. The hull keeps a minimum share against work that is independent of the tolerance, since
// a coarser hull would not reduce it.
class ToleranceControl {
 public:
  explicit ToleranceControl(const ToleranceRules& rules, double first_px = 1);
  // Adds a frame's load as shares of the frame's time: hull, and all else. True if the tolerance was changed: at most
  // once per kStep_us.
  bool add(int64_t now_us, double hull_busy, double other_busy);
  double tolerance_px() const { return tolerance_px_; }

  static constexpr int64_t kStep_us = 500'000;

 private:
  ToleranceRules rules_;
  double tolerance_px_;
  bool began_ = false;
  int64_t stepped_us_ = 0;
  std::vector<double> ratios_;  // hull's work over its share, since the last step took effect in the cameras
};

}  // namespace fourdvt::live
