// SPDX-License-Identifier: Apache-2.0
// Figures of the last second. Does NOT read clocks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "base/robust.h"

namespace fourdvt::live {

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

}  // namespace fourdvt::live
