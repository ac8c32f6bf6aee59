// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/pass_clock.h"

#include <algorithm>

namespace fourdvt::study {

Status PassClock::start() {
  FOURDVT_ASSIGN(color_, gpu::makeTexture(device_, {.width = 1, .height = 1, .label = "pass clock"}));
  FOURDVT_ASSIGN(target_, gpu::makeTarget(device_, {.colors = {color_.id()}, .label = "pass clock"}));
  device_.observe(this);
  return {};
}

// Draws one more pass and reads it: the GPU works in order.
void PassClock::wait() {
  device_.observe(nullptr);
  device_.beginPass({.target = target_.id(), .clear_color = true, .label = "pass clock"});
  device_.endPass();
  uint8_t pixel[4];
  const Status read = device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel);
  (void)read;  // the picture that is drawn shows a lost device
  device_.observe(this);
}

void PassClock::begins(const char* label) {
  label_ = label;
  start_ = Clock::now();
}

void PassClock::ends() {
  if (label_ != "upload") wait();
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.label == label_; });
  if (part == parts_.end())
    parts_.push_back({label_, seconds});
  else
    part->seconds += seconds;
}

}  // namespace fourdvt::study
