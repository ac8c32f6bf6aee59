// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/json_text.h"

namespace fourdvt::capture {
namespace {

using Json = nlohmann::json;

// A frame's own value, or the one that all frames share.
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
  // A key that is there holds a number.
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

Error badFrame(const std::string& where, const std::string& what) {
  return {ErrorId::CameraPose, where + ": " + what + "; export the calibration again"};
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

Status nerfstudioFocals(const FrameValues& values, PinholeCamera& camera, const std::string& where) {
  if (!values.holdsNumbers({"w", "h", "fl_x", "fl_y", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2"}))
    return badFrame(where, "w, h, fl_x, fl_y, cx, cy and coefficients must be numbers");
  const auto side = [&](const char* key) { return std::clamp(values.orZero(key), -1.0, 1e6); };
  camera.width = static_cast<int>(side("w"));
  camera.height = static_cast<int>(side("h"));
  auto fx = values.number("fl_x");
  if (const auto angle = values.number("camera_angle_x"); !fx && angle && camera.width > 0)
    fx = camera.width / 2.0 / std::tan(*angle / 2);
  if (!fx) return badFrame(where, "no fl_x, and no camera_angle_x with w");
  if (camera.width < 1 && !values.number("cx")) return badFrame(where, "no w, h and no cx, cy");
  camera.fx = *fx;
  camera.fy = values.number("fl_y").value_or(*fx);
  camera.cx = values.number("cx").value_or(camera.width / 2.0);
  camera.cy = values.number("cy").value_or(camera.height / 2.0);
  return {};
}

// Columns of camera to world are the camera's axes and its position.
Status nerfstudioPose(const Json& frame, CaptureCamera& camera, const std::string& where) {
  const auto matrix = frame.find("transform_matrix");
  glm::dmat4 world_from_cam(1);
  bool valid = matrix != frame.end() && matrix->is_array() && matrix->size() >= 3;
  size_t in_a_row = 0;
  for (int row = 0; valid && row < 3; ++row) {
    const Json& numbers = (*matrix)[row];
    valid = numbers.is_array() && numbers.size() == 4;
    if (numbers.is_array()) in_a_row = std::max(in_a_row, numbers.size());
    for (int column = 0; valid && column < 4; ++column) {
      valid = numbers[column].is_number();
      if (valid) world_from_cam[column][row] = numbers[column].get<double>();
    }
  }
  if (!valid)
    return badFrame(where, "transform_matrix must be four rows of four numbers" + tooManyNumbers(in_a_row, 4));
  glm::dmat3 axes(world_from_cam);
  axes[1] = -axes[1];
  axes[2] = -axes[2];
  const glm::dmat3 rotation = glm::transpose(axes);
  return setPose(rotation, -(rotation * glm::dvec3(world_from_cam[3])), camera, where);
}

Result<ImportedCamera> nerfstudioCamera(const Json& frame, const Json& root, const std::string& where) {
  if (!frame.is_object()) return badFrame(where, "is no object");
  const FrameValues values(frame, root);
  ImportedCamera out;
  out.pictures = values.text("file_path");
  std::replace(out.pictures.begin(), out.pictures.end(), '\\', '/');  // as written on Windows
  if (out.pictures.empty()) return badFrame(where, "no file_path, which names the camera");
  FOURDVT_TRY(nerfstudioFocals(values, out.camera.pinhole, where));
  FOURDVT_ASSIGN(out.camera.distortion, nerfstudioLens(values, where));
  FOURDVT_TRY(nerfstudioPose(frame, out.camera, where));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

void nameByPictures(std::vector<ImportedCamera>& cameras) {
  std::set<std::string> stems;
  for (ImportedCamera& imported : cameras) {
    imported.camera.pinhole.name = std::filesystem::path(imported.pictures).stem().string();
    stems.insert(imported.camera.pinhole.name);
  }
  if (stems.size() == cameras.size()) return;
  for (ImportedCamera& imported : cameras) {
    const std::filesystem::path folder = std::filesystem::path(imported.pictures).parent_path();
    imported.camera.pinhole.name = folder.filename().string();
    imported.pictures = folder.string();
  }
}

}  // namespace

Result<ImportedCalibration> parseNerfstudio(const std::string& text, const std::string& path) {
  FOURDVT_ASSIGN(const Json root, parseJsonText(text, path, ErrorId::FileUnreadable));
  if (!root.is_object() || !root.contains("frames") || !root["frames"].is_array() || root["frames"].empty()) {
    return Error{ErrorId::FileUnreadable,
                 path + ": not nerfstudio's JSON with a list \"frames\"; export the calibration again"};
  }
  ImportedCalibration out{"nerfstudio", path, {}, {}, WorldAxis::Z};
  for (const Json& frame : root["frames"]) {
    const std::string where = path + ": frame " + std::to_string(out.cameras.size());
    FOURDVT_ASSIGN(out.cameras.emplace_back(), nerfstudioCamera(frame, root, where));
  }
  nameByPictures(out.cameras);
  return out;
}

}  // namespace fourdvt::capture
