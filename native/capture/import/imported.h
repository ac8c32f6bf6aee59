// SPDX-License-Identifier: Apache-2.0
// Contents of a calibration file: cameras in the file's world and unit, and both as defined by its format.
// Readers of this folder parse bytes in memory and convert every convention except world and unit to the capture's: x
// right, y down, z forward, first pixel centre at 0.5. They open no other files, and return errors that name the file
// for any malformed input.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "capture/camera_names.h"
#include "capture/capture.h"

namespace fourdvt::capture {

enum class WorldAxis { X, MinusX, Y, MinusY, Z, MinusZ };

const char* axisName(WorldAxis axis);  // "-Z"
std::optional<WorldAxis> axisNamed(std::string_view name);
// Rotation that turns `up` into Y and maps axes to axes.
glm::dmat3 turnToY(WorldAxis up);

// Lens parameters that are relative to a picture size which the calibration lacks.
struct RelativeLens {
  enum class Unit { Width, LongerSide };
  Unit unit = Unit::Width;
  double focal = 0;                     // relative to `unit`; 0: the camera has focal lengths
  double focal_y = 0;                   // relative to the height; 0: equal to x
  std::optional<glm::dvec2> principal;  // offset from the picture's centre, relative to `unit`; none: the camera has
                                        // a principal point
};
// Sets the camera's lens by its size.
void setLens(const RelativeLens& lens, PinholeCamera& camera);

struct ImportedCamera {
  CaptureCamera camera;  // width and height 0 if the file lacks them
  std::string pictures;  // file or folder named by the calibration, relative to it or absolute; mostly empty
  std::string listed;    // fallback for `pictures` where nothing has the camera's name
  std::string mattes;    // file or folder named by the calibration
  // Candidate file names, best first; empty: the camera's name. importCapture keeps the one that exists, and names the
  // camera by it.
  std::vector<std::string> file_names;
  std::optional<RelativeLens> relative;  // to be set when the size is available
  const std::string& fileName() const { return file_names.empty() ? camera.pinhole.name : file_names.front(); }
};

// Name suitable for capture files: blanks and characters special to shells and URLs become "_" ("cam 00": "cam_00").
std::string plainName(std::string name);

struct ImportedCalibration {
  std::string kind;  // for display: "Qualisys"
  std::string path;  // file or folder that was read
  std::vector<ImportedCamera> cameras;
  std::optional<double> metres_per_unit;  // none: the format defines no unit
  std::optional<WorldAxis> up;            // none: the format defines no up axis
  std::vector<std::string> warnings;      // one line each
  std::vector<std::string> details;       // skipped contents without effect, one line each
};

// Adds cameras by which a calibration lists pictures.
void addListed(const std::vector<ListedCamera>& cameras, ImportedCalibration& out);

// Unread keys of a calibration file: known ones become one warning, others a detail.
class KeyNotes {
 public:
  // `read`: keys used by the reader; `known`: unread keys of the format that affect cameras or pictures.
  KeyNotes(std::set<std::string> read, std::set<std::string> known)
      : read_(std::move(read)), known_(std::move(known)) {}
  void see(const std::string& key);
  // Adds at most one warning and one detail to the calibration.
  void finish(ImportedCalibration& out) const;

 private:
  std::set<std::string> read_, known_, not_read_, unknown_;
};

}  // namespace fourdvt::capture
