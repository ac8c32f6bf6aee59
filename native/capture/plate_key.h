// SPDX-License-Identifier: Apache-2.0
// Mattes of a camera that has none of its own, from the plates of the empty studio in the capture's background folder:
// chroma key (matte.h) or key against a natural background (background_key.h).
#pragma once

#include <string>

#include "base/result.h"
#include "capture/background_model.h"
#include "capture/capture.h"

namespace fourdvt::capture {

class PlateKey {
 public:
  // Reads the camera's plates. Errors: FileMissing, FileUnreadable, FrameSize.
  static Result<PlateKey> open(const Capture& capture, const CaptureCamera& camera);
  // One channel. `picture`: RGB, as distorted as the plates. `residual_levels`: see PlateFit; 0 for a chroma key.
  Image matte(const Image& picture, float* residual_levels = nullptr) const;
  bool natural() const { return natural_; }
  const BackgroundModel& model() const { return model_; }  // of a natural background
  const std::string& path() const { return path_; }        // of the first plate

 private:
  std::string path_;
  bool natural_ = false;
  Image plate_;            // chroma key
  BackgroundModel model_;  // natural background
};

inline constexpr float kMostResidual = 15;  // levels, in half of the pixels: a plate that fits leaves less
// FileUnreadable: a plate that does not fit the pictures.
Error plateDoesNotFit(const std::string& plate, const std::string& pictures, const std::string& camera);

}  // namespace fourdvt::capture
