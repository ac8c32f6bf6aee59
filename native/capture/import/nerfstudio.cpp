// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "capture/camera_names.h"
#include "capture/import/camera_numbers.h"
#include "capture/import/imported.h"
#include "capture/import/readers.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

using Json = nlohmann::json;
constexpr double kHalfTurn = 3.14159;  // radians

// Value of a frame, or else the value common to all frames.
class FrameValues {
 public:
  FrameValues(const Json& frame, const Json& shared) : frame_(frame), shared_(shared) {}
  std::optional<double> number(const char* key) const {
    const Json* value = find(key);
    if (!value || !value->is_number()) return std::nullopt;
    return value->get<double>();
  }
  double orZero(const char* key) const { return number(key).value_or(0); }
  bool flag(const char* key) const {
    const Json* value = find(key);
    return value && value->is_boolean() && value->get<bool>();
  }
  std::string text(const char* key) const {
    const Json* value = find(key);
    return value && value->is_string() ? value->get<std::string>() : std::string();
  }
  // Returns true if each of the keys is missing or a number.
  bool holdsNumbers(std::initializer_list<const char*> keys) const {
    for (const char* key : keys)
      if (const Json* value = find(key); value && !value->is_number()) return false;
    return true;
  }

 private:
  const Json* find(const char* key) const {
    for (const Json* node : {&frame_, &shared_})
      if (const auto it = node->find(key); it != node->end()) return &*it;
    return nullptr;
  }
  const Json &frame_, &shared_;
};

std::string withSlashes(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');  // Windows paths
  return path;
}

Result<Distortion> nerfstudioLens(const FrameValues& values, const std::string& where) {
  const std::string given = values.text("camera_model");
  const std::string model = given.empty() && values.flag("is_fisheye") ? "OPENCV_FISHEYE" : given;  // instant-ngp
  const double k1 = values.orZero("k1"), k2 = values.orZero("k2"), k3 = values.orZero("k3"), k4 = values.orZero("k4");
  if (model == "OPENCV_FISHEYE") return Distortion{.k1 = k1, .k2 = k2, .k3 = k3, .k4 = k4, .fisheye = true};
  const std::set<std::string> known{"", "OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL"};
  if (!known.count(model) || k4 != 0) {
    return Error{
        ErrorId::CameraModel,
        where + (k4 != 0 ? ": k4 belongs to OPENCV_FISHEYE alone" : ": camera_model \"" + model + "\" is not read") +
            "; use OPENCV, OPENCV_FISHEYE or PINHOLE"};
  }
  return Distortion{k1, k2, values.orZero("p1"), values.orZero("p2"), k3};
}

// Half of a side in focal lengths from an angle of view in radians; empty without one.
Result<double> focalOfAngle(const FrameValues& values, const char* key, const std::string& where) {
  const auto angle = values.number(key);
  if (!angle) return 0.0;
  const double focal = 0.5 / std::tan(*angle / 2);
  if (*angle > 0 && *angle < kHalfTurn && std::isfinite(focal)) return focal;
  return badCalibration(where, std::string(key) + " must be an angle in radians, above 0 and below pi");
}

// Sets focal lengths and principal point, absolute or relative to a missing size.
Status nerfstudioFocals(const FrameValues& values, ImportedCamera& imported, const std::string& where) {
  if (!values.holdsNumbers({"w", "h", "fl_x", "fl_y", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2"}))
    return badCalibration(where, "w, h, fl_x, fl_y, cx, cy and coefficients must be numbers");
  PinholeCamera& camera = imported.camera.pinhole;
  const auto side = [&](const char* key) { return std::clamp(values.orZero(key), -1.0, 1e6); };
  camera.width = static_cast<int>(side("w"));
  camera.height = static_cast<int>(side("h"));
  RelativeLens lens;
  const auto fx = values.number("fl_x"), cx = values.number("cx"), cy = values.number("cy");
  if (!fx) {
    FOURDVT_ASSIGN(lens.focal, focalOfAngle(values, "camera_angle_x", where));
    FOURDVT_ASSIGN(lens.focal_y, focalOfAngle(values, "camera_angle_y", where));
    if (lens.focal == 0) return badCalibration(where, "no fl_x and no camera_angle_x");
  }
  camera.fx = fx.value_or(1);
  camera.fy = values.number("fl_y").value_or(camera.fx);
  if (cx && cy)
    camera.cx = *cx, camera.cy = *cy;
  else
    lens.principal = glm::dvec2(0);
  if (camera.width > 0 && camera.height > 0)
    setLens(lens, camera);
  else if (!fx || lens.principal)
    imported.relative = lens;
  return {};
}

// Sets the pose. Columns of camera to world are the camera's axes and its position.
Status nerfstudioPose(const Json& frame, CaptureCamera& camera, const std::string& where) {
  const auto matrix = frame.find("transform_matrix");
  glm::dmat4 rows(1);
  bool valid = matrix != frame.end() && matrix->is_array() && matrix->size() >= 3;
  size_t in_a_row = 0;
  for (int row = 0; valid && row < 3; ++row) {
    const Json& numbers = (*matrix)[row];
    if (numbers.is_array()) in_a_row = std::max(in_a_row, numbers.size());
    valid = jsonNumbers(numbers, 4, &rows[row][0]);
  }
  if (!valid)
    return badCalibration(where, "transform_matrix must be four rows of four numbers" + tooManyNumbers(in_a_row, 4));
  const glm::dmat4 world_from_cam = glm::transpose(rows);
  glm::dmat3 axes(world_from_cam);
  axes[1] = -axes[1];
  axes[2] = -axes[2];
  const glm::dmat3 rotation = glm::transpose(axes);
  return setPose(rotation, -(rotation * glm::dvec3(world_from_cam[3])), camera, where);
}

Result<ImportedCamera> nerfstudioCamera(const Json& frame, const Json& root, const std::string& where) {
  if (!frame.is_object()) return badCalibration(where, "is no object");
  const FrameValues values(frame, root);
  ImportedCamera out;
  out.pictures = withSlashes(values.text("file_path"));
  out.mattes = withSlashes(values.text("mask_path"));
  if (out.pictures.empty()) return badCalibration(where, "no file_path, which names the camera");
  FOURDVT_TRY(nerfstudioFocals(values, out, where));
  FOURDVT_ASSIGN(out.camera.distortion, nerfstudioLens(values, where));
  FOURDVT_TRY(nerfstudioPose(frame, out.camera, where));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

// Folder of a camera's mattes. "mask_path" names the matte of one picture: its folder contains those of the camera
// alone, or those of all cameras.
std::string mattesOf(const std::vector<ImportedCamera>& frames, size_t first, bool folder) {
  const std::filesystem::path path = frames[first].mattes;
  const auto shares = [&](const ImportedCamera& other) {
    return std::filesystem::path(other.mattes).parent_path() == path.parent_path() && other.mattes != path &&
           other.pictures != frames[first].pictures;
  };
  const std::string ending = path.extension().string();
  const bool picture =
      ending == ".png" || ending == ".jpg" || ending == ".jpeg" || ending == ".PNG" || ending == ".JPG";
  const bool own = folder || std::none_of(frames.begin(), frames.end(), shares);
  return picture && own && path.has_parent_path() ? path.parent_path().string() : path.string();
}

// Merges frames of one camera at several instants.
Result<std::vector<ImportedCamera>> withoutInstants(const std::vector<ImportedCamera>& frames,
                                                    const std::string& path) {
  std::vector<ListedPicture> pictures;
  for (const ImportedCamera& frame : frames)
    pictures.push_back({frame.camera, frame.pictures, path + ": frame " + std::to_string(pictures.size()) + ": "});
  FOURDVT_ASSIGN(const auto listed, camerasOfPictures(pictures));
  std::vector<ImportedCamera> out;
  for (const ListedCamera& one : listed) {
    ImportedCamera& camera = out.emplace_back(frames[one.first]);
    if (!camera.mattes.empty()) camera.mattes = mattesOf(frames, one.first, one.folder);
    camera.camera.pinhole.name = one.camera.pinhole.name;
    camera.pictures = one.pictures;
  }
  return out;
}

// Notes unread keys: those that affect cameras or pictures, and others.
void noteKeys(const Json& root, ImportedCalibration& out) {
  KeyNotes notes({"frames",
                  "file_path",
                  "mask_path",
                  "transform_matrix",
                  "w",
                  "h",
                  "fl_x",
                  "fl_y",
                  "cx",
                  "cy",
                  "k1",
                  "k2",
                  "k3",
                  "k4",
                  "p1",
                  "p2",
                  "camera_model",
                  "is_fisheye",
                  "camera_angle_x",
                  "camera_angle_y"},
                 {"applied_scale", "applied_transform", "depth_file_path", "fisheye_crop_radius", "lidar_file_path",
                  "rolling_shutter", "time", "test_filenames", "train_filenames", "val_filenames"});
  for (const auto& [key, value] : root.items()) notes.see(key);
  for (const Json& frame : root["frames"])
    for (const auto& [key, value] : frame.items()) notes.see(key);
  notes.finish(out);
}

}  // namespace

Result<ImportedCalibration> parseNerfstudio(const std::string& text, const std::string& path) {
  FOURDVT_ASSIGN(const Json root, parseJsonText(text, path, ErrorId::FileUnreadable));
  if (!root.is_object() || !root.contains("frames") || !root["frames"].is_array() || root["frames"].empty()) {
    return Error{ErrorId::FileUnreadable,
                 path + ": not nerfstudio's JSON with a list \"frames\"; export the calibration again"};
  }
  ImportedCalibration out{"nerfstudio", path, {}, {}, WorldAxis::Z, {}, {}};
  std::vector<ImportedCamera> frames;
  for (const Json& frame : root["frames"]) {
    const std::string where = path + ": frame " + std::to_string(frames.size());
    FOURDVT_ASSIGN(frames.emplace_back(), nerfstudioCamera(frame, root, where));
  }
  FOURDVT_ASSIGN(out.cameras, withoutInstants(frames, path));
  noteKeys(root, out);
  return out;
}

}  // namespace fourdvt::capture
