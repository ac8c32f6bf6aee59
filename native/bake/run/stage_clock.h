// SPDX-License-Identifier: Apache-2.0
// Adds up seconds of work by stage. Stages overlap in time, so that the sum may exceed the wall clock. Thread-safe.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "bake/run/stage_table.h"

namespace fourdvt::bake {

class StageClock {
 public:
  // Counts the time from its construction to its destruction.
  class Span {
   public:
    Span(StageClock& clock, Stage stage) : clock_(clock), stage_(stage), start_(Now::now()) {}
    ~Span() { clock_.add(stage_, std::chrono::duration<double>(Now::now() - start_).count()); }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;

   private:
    using Now = std::chrono::steady_clock;
    StageClock& clock_;
    const Stage stage_;
    const Now::time_point start_;
  };

  void add(Stage stage, double seconds) {
    std::lock_guard lock(mutex_);
    seconds_[static_cast<size_t>(stage)] += seconds;
  }
  // Seconds by the stages' names; stages that never ran are left out.
  std::map<std::string, double> seconds() const {
    std::lock_guard lock(mutex_);
    std::map<std::string, double> out;
    for (size_t s = 0; s < kStages.size(); ++s)
      if (seconds_[s] > 0) out[kStages[s].name] = seconds_[s];
    return out;
  }

 private:
  mutable std::mutex mutex_;
  std::array<double, kStages.size()> seconds_{};
};

}  // namespace fourdvt::bake
