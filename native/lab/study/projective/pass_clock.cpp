// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/pass_clock.h"

namespace fourdvt::study {

Status PassClock::prepare() {
  FOURDVT_ASSIGN(color_, gpu::makeTexture(device_, {.width = 1, .height = 1, .label = "pass clock"}));
  FOURDVT_ASSIGN(target_, gpu::makeTarget(device_, {.colors = {color_.id()}, .label = "pass clock"}));
  return {};
}

// The GPU works in order, and this is the last piece.
void PassClock::wait() {
  device_.beginPass({.target = target_.id(), .clear_color = true, .label = "pass clock"});
  device_.endPass();
  uint8_t pixel[4];
  const Status read = device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel);
  (void)read;  // a lost device is told by the picture that is drawn
}

void PassClock::add(const std::string& label, Clock::time_point since) {
  const double seconds = std::chrono::duration<double>(Clock::now() - since).count();
  for (Part& part : parts_)
    if (part.label == label) {
      part.seconds += seconds;
      return;
    }
  parts_.push_back({label, seconds});
}

void PassClock::updateTexture(gpu::TextureId texture, const gpu::Region& region, const void* pixels, int stride_bytes,
                              int layer) {
  const auto start = Clock::now();
  device_.updateTexture(texture, region, pixels, stride_bytes, layer);
  add("upload", start);
}

void PassClock::beginPass(const gpu::Pass& pass) {
  label_ = pass.label;
  start_ = Clock::now();
  device_.beginPass(pass);
}

void PassClock::endPass() {
  device_.endPass();
  wait();
  add(label_, start_);
}

}  // namespace fourdvt::study
