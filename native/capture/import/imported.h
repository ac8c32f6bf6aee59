// SPDX-License-Identifier: Apache-2.0
// Contents of a calibration file: cameras in the file's own world and unit, and both by its format's definition.
//
// The readers of this folder parse bytes in memory and turn every convention but these two into the capture's: x right,
// y down, z forward, the first pixel's centre at 0.5. They do NOT look for pictures or other files. They read what
// others wrote: whatever it is, they return an error that names the file.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

enum class WorldAxis { X, MinusX, Y, MinusY, Z, MinusZ };

const char* axisName(WorldAxis axis);  // "-Z"
std::optional<WorldAxis> axisNamed(std::string_view name);
// The rotation that turns `up` into Y; the axes stay axes.
glm::dmat3 turnToY(WorldAxis up);

struct ImportedCamera {
  CaptureCamera camera;  // width and height 0 where the file does not give them
  std::string pictures;  // file or folder that the calibration names, relative to it or absolute; mostly empty
};

struct ImportedCalibration {
  std::string kind;  // for people: "Qualisys"
  std::string path;  // file or folder that was read
  std::vector<ImportedCamera> cameras;
  std::optional<double> metres_per_unit;  // none: the format defines no unit
  std::optional<WorldAxis> up;            // none: the format defines no axis
};

}  // namespace fourdvt::capture
