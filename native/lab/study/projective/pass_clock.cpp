// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/pass_clock.h"

#include <algorithm>

namespace fourdvt::study {

Status PassClock::start() {
  FOURDVT_TRY(drain_.prepare(device_));
  device_.observe(this);
  return {};
}

void PassClock::begins(const char* label) {
  label_ = label;
  watch_ = {};
}

void PassClock::ends() {
  if (label_ != "upload") {
    device_.observe(nullptr);
    const Status read = drain_.wait(device_);
    (void)read;  // the picture that is drawn shows a lost device
    device_.observe(this);
  }
  const double seconds = watch_.seconds();
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.label == label_; });
  if (part == parts_.end())
    parts_.push_back({label_, seconds});
  else
    part->seconds += seconds;
}

}  // namespace fourdvt::study
