// SPDX-License-Identifier: Apache-2.0
// Mattes from plates of the empty studio, by a chroma key or by a key against a natural background (background_key.h),
// and the room's picture. Colour spill stays.
#pragma once

#include <string>

#include "base/image.h"
#include "base/result.h"
#include "capture/capture.h"
#include "mattes/background_model.h"

namespace fourdvt::mattes {

// Distances between picture and plate in the CbCr plane (BT.709, full range), in levels of 255.
struct ChromaKeyOptions {
  float background_below = 9;   // alpha 0
  float foreground_above = 30;  // alpha 255; a soft ramp lies between the two
};

// `picture` and `plate` have 3 channels and equal sizes. Returns 1 channel, 255 in the foreground, without specks of up
// to two pixels and without pinholes.
Image chromaKey(const Image& picture, const Image& plate, const ChromaKeyOptions& options = {});

class PlateKey {
 public:
  // Reads the camera's plates. Errors: FileMissing, FileUnreadable, FrameSize.
  static Result<PlateKey> open(const capture::Capture& capture, const capture::CaptureCamera& camera);
  // One channel. `picture`: RGB, as distorted as the plates. `residual_levels`: see PlateFit; 0 for a chroma key.
  Image matte(const Image& picture, float* residual_levels = nullptr) const;
  bool natural() const { return natural_; }
  const BackgroundModel& model() const { return model_; }  // natural background
  const std::string& path() const { return path_; }        // first plate

 private:
  std::string path_;
  bool natural_ = false;
  Image plate_;            // chroma key
  BackgroundModel model_;  // natural background
};

inline constexpr float kMaxResidual = 15;  // maximum median absolute residual of plates that fit, levels
// Error FileUnreadable: a plate that does not fit the pictures.
Error plateDoesNotFit(const std::string& plate, const std::string& pictures, const std::string& camera);

// Mean of a camera's plates, undistorted to its pinhole camera: RGBA, alpha 0 outside the filmed picture. Errors: those
// of capture::readPlates; the message names "room" in capture.json as what needs the plate.
Result<Image> readRoomPlate(const capture::Capture& capture, const capture::CaptureCamera& camera);

}  // namespace fourdvt::mattes
