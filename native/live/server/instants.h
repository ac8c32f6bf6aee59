// SPDX-License-Identifier: Apache-2.0
// Brings together the pictures that cameras took at one instant. Time is cut into slots of a frame's length; a picture
// belongs to the slot that is nearest to its capture. Holds few slots. Does NOT read clocks and has no threads.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

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

}  // namespace fourdvt::live
