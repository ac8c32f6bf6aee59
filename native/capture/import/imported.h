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

// Parts of a lens that a calibration gives by the size of the pictures, and not the size.
struct RelativeLens {
  enum class Unit { Width, LongerSide };
  Unit unit = Unit::Width;
  double focal = 0;                     // of the unit; 0: the camera has its focal lengths
  double focal_y = 0;                   // of the height; 0: that of x
  std::optional<glm::dvec2> principal;  // off the centre of the picture, of the unit; none: the camera has it
};
// Sets the camera's lens by its size.
void setLens(const RelativeLens& lens, PinholeCamera& camera);

struct ImportedCamera {
  CaptureCamera camera;  // width and height 0 where the file does not give them
  std::string pictures;  // file or folder that the calibration names, relative to it or absolute; mostly empty
  std::string listed;    // the same, to be looked for where there is nothing called by the camera's name
  std::string mattes;    // file or folder that the calibration names
  // Names of its files, best first; none: the camera's. importCapture keeps the one that it finds, and names the camera
  // by it.
  std::vector<std::string> file_names;
  std::optional<RelativeLens> relative;  // to be set once the size is known
  const std::string& fileName() const { return file_names.empty() ? camera.pinhole.name : file_names.front(); }
};

// A name that capture files can be called by: blanks and signs that shells and pages give a meaning become "_" ("cam
// 00": "cam_00").
std::string plainName(std::string name);

struct ImportedCalibration {
  std::string kind;  // for people: "Qualisys"
  std::string path;  // file or folder that was read
  std::vector<ImportedCamera> cameras;
  std::optional<double> metres_per_unit;  // none: the format defines no unit
  std::optional<WorldAxis> up;            // none: the format defines no axis
  std::vector<std::string> warnings;      // a line each
  std::vector<std::string> details;       // what was passed over and does not matter, a line each
};

}  // namespace fourdvt::capture
