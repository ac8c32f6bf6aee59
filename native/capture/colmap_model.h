// SPDX-License-Identifier: Apache-2.0
// Parts common to COLMAP's text and binary models: camera models, and cameras from their numbers. Does NOT read files.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "capture/capture.h"

namespace fourdvt::capture {

inline constexpr int kMaxColmapParameters = 12;

struct ColmapIntrinsics {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Distortion distortion;
};

struct ColmapModel {
  int number;  // in binary models
  std::string_view name;
  int parameters;
  ColmapIntrinsics (*make)(const double* parameters);
};

// `where` begins the messages: file and place. Errors: CameraModel.
Result<const ColmapModel*> colmapModel(std::string_view name, const std::string& where);
Result<const ColmapModel*> colmapModel(int number, const std::string& where);

Error colmapPoseError(const std::string& where, const std::string& what);

// Errors: CameraPose (a size that no picture has, numbers that are not finite, focal lengths that are not positive).
Result<ColmapIntrinsics> makeIntrinsics(const ColmapModel& model, int width, int height, const double* parameters,
                                        const std::string& where);

// `pose`: QW QX QY QZ TX TY TZ. The image's name gives the camera's: "cam00.png" and "cam00/000000.png" both name
// "cam00". Errors: CameraPose.
Result<CaptureCamera> makeColmapCamera(const ColmapIntrinsics& intrinsics, const std::array<double, 7>& pose,
                                       std::string_view image_name, const std::string& where);

}  // namespace fourdvt::capture
