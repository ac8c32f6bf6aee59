// SPDX-License-Identifier: Apache-2.0
// Camera-based texturing methods on a capture's own surfaces, before the codec: at the held-out cameras, and at the
// input cameras, each left out (Montage4D, Du et al. 2019, Table 2). On the capture's test frames.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "gpu/device.h"
#include "measure/picture_score.h"
#include "render/method.h"

namespace fourdvt::study {

struct MethodScore {
  std::string method, sequence;
  size_t views = 0;
  measure::PictureScore held_out;      // means
  measure::PictureScore left_one_out;  // at the input cameras, each without its own picture; NaN: not measured
  double rmse_left_one_out = 0;        // RGB on the foreground, 0…1
  double picture_s = 0;                // per held-out picture, read-back included
};

struct MethodScoreOptions {
  std::vector<std::string> methods;
  render::MethodOptions method;
  bool leaves_one_out = true;
  bool quick = false;  // one test frame per sequence
};

// Errors: those of captures and pictures, of makeCameraMethod; FileMissing if no sequence has test frames.
Result<std::vector<MethodScore>> scoreMethods(gpu::Device& device, const capture::Capture& capture,
                                              const OpenVideo& open_video, const MethodScoreOptions& options,
                                              const std::function<void(const std::string&, uint32_t)>& on_frame = {});

// Fixed width, with units.
std::string methodTable(const std::vector<MethodScore>& scores);

}  // namespace fourdvt::study
