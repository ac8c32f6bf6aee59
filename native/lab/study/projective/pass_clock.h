// SPDX-License-Identifier: Apache-2.0
// Measures the time of a device's passes, by their label. Waits for the GPU after every pass, so that the parts add up
// to more than an undisturbed frame.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "gpu/device.h"

namespace fourdvt::study {

class PassClock final : public gpu::DeviceObserver {
 public:
  explicit PassClock(gpu::Device& device) : device_(device) {}
  ~PassClock() override { device_.observe(nullptr); }
  Status start();  // Errors: GpuFailure

  struct Part {
    std::string label;  // "upload": updates of textures
    double seconds = 0;
  };
  const std::vector<Part>& parts() const { return parts_; }  // in order of their first use
  void forget() { parts_.clear(); }

  void begins(const char* label) override;
  void ends() override;

 private:
  using Clock = std::chrono::steady_clock;
  void wait();

  gpu::Device& device_;
  gpu::Texture color_;
  gpu::Target target_;
  std::string label_;
  Clock::time_point start_;
  std::vector<Part> parts_;
};

}  // namespace fourdvt::study
