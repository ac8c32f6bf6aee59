// SPDX-License-Identifier: Apache-2.0
// Brings together the pictures that cameras took at one instant. Time is cut into slots of a frame's length; a picture
// belongs to the slot that is nearest to its capture. Holds few slots. Does NOT read clocks and has no threads.
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
  double wait_s = 0.1;  // an instant is made of what has come so long after it
  double lost_s = 0.5;  // a camera without a picture for so long is not waited for
};

constexpr size_t kFewestPictures = 2;  // that a hull can be made of

struct TimedPicture {
  CameraPicture picture;
  int64_t captured_us = 0;  // by the server's clock
};

struct Instant {
  int64_t slot = 0;                                           // ascending by 1 or more
  int64_t captured_us = 0;                                    // mean of its pictures
  std::vector<std::shared_ptr<const TimedPicture>> pictures;  // per camera; null: none
  bool complete = false;                                      // nobody who was waited for is missing
  size_t count() const;
};

class Instants {
 public:
  explicit Instants(const InstantRules& rules);
  void setConnected(size_t camera, bool connected, int64_t now_us);
  // False: it came too late, or from a time that cannot be. `now_us` and captured_us: the server's clock.
  bool add(size_t camera, std::shared_ptr<const TimedPicture> picture, int64_t now_us);

  struct Taken {
    Instant instant;
    std::vector<Instant> skipped;  // older ones, ascending, that had all pictures
  };
  // The newest instant that is due: all cameras that are waited for have a picture, or wait_s has passed. What is older
  // is over. Instants with fewer than kFewestPictures pictures are left out.
  std::optional<Taken> take(int64_t now_us);
  // When the next instant falls due at the latest; none: no pictures are there.
  std::optional<int64_t> due_us() const;

  bool connected(size_t camera) const { return cameras_[camera].connected; }
  bool lost(size_t camera, int64_t now_us) const;  // connected, but no picture for lost_s
  uint64_t late(size_t camera) const { return cameras_[camera].late; }
  uint64_t skipped() const { return skipped_; }  // instants that were over before they were taken
  uint64_t tooFew() const { return too_few_; }
  size_t held() const { return slots_.size(); }

 private:
  struct Camera {
    bool connected = false;
    bool seen = false;              // since it connected
    int64_t came_us = 0;            // its last picture, by arrival, or itself
    int64_t slot = 0, time_us = 0;  // its last picture
    int slow = 0;                   // pictures in a row that took longer than wait_s to come
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
  size_t most_slots_;
  std::vector<Camera> cameras_;
  std::map<int64_t, Slot> slots_;  // none is empty of pictures
  int64_t closed_ = INT64_MIN;     // this slot and those before it are over
  uint64_t skipped_ = 0, too_few_ = 0;
};

// A camera's clock against the server's, from questions and answers as in NTP: of the last answers, those with the
// shortest round trips decide. Does NOT read clocks.

class ClockOffset {
 public:
  // `now_us`: by the server's clock, when the answer came. Answers to questions that cannot have been put (from the
  // future, or more than kMostRoundTrip_us ago) are left out. A camera whose clock jumps by more than kJump_us begins
  // anew.
  void add(const ClockAnswer& answer, int64_t now_us);
  void reset() { answers_.clear(); }
  bool known() const { return !answers_.empty(); }
  int64_t offset_us() const { return offset_us_; }  // camera's clock minus server's; 0 before the first answer
  int64_t toServer(int64_t camera_us) const { return camera_us - offset_us_; }

  static constexpr int64_t kMostRoundTrip_us = 5'000'000, kJump_us = 250'000;
  static constexpr int64_t kLatest_us = int64_t(1) << 60;  // times beyond are no times

 private:
  struct Answer {
    int64_t round_trip_us, offset_us;
  };
  void decide();

  std::deque<Answer> answers_;
  int64_t offset_us_ = 0;
};

// Figures of the last second. Does NOT read clocks.

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
  static constexpr size_t kMost = 1000;

  static bool isRecent(const Value& v, int64_t now_us) {
    return v.time_us <= now_us && now_us - v.time_us < kSecond_us;
  }
  void forget(int64_t now_us) {
    while (!values_.empty() && (!isRecent(values_.front(), now_us) || values_.size() > kMost)) values_.pop_front();
  }

  std::deque<Value> values_;
};

// Moves the tolerance of outlines such that the work for a frame takes a wanted share of the frame's time: up at once,
// down slowly. Work that the tolerance does not change leaves the hull at least a share of its own, since a coarser
// hull would not make it cheaper. Does NOT measure times.

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
