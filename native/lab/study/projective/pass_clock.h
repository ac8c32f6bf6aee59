// SPDX-License-Identifier: Apache-2.0
// Measures the time of a device's passes, by their label. Waits for the GPU after every pass, so that the parts add up
// to more than an undisturbed frame.
#pragma once

#include <string>
#include <vector>

#include "base/watch.h"
#include "lab/study/run/gpu_drain.h"

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
  gpu::Device& device_;
  GpuDrain drain_;
  std::string label_;
  Watch watch_;
  std::vector<Part> parts_;
};

}  // namespace fourdvt::study
