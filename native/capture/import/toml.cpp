// SPDX-License-Identifier: Apache-2.0
#include <toml++/toml.h>

#include <cmath>

#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxTomlNumbers = 64;

// Numbers of an array, or of an array of arrays, row by row; empty if it is anything else.
std::vector<double> tomlNumbers(const toml::table& table, const char* key) {
  std::vector<double> out;
  const toml::array* rows = table[key].as_array();
  if (!rows) return {};
  for (const toml::node& row : *rows) {
    const toml::array* inner = row.as_array();
    if (inner) {
      for (const toml::node& node : *inner) out.push_back(node.value<double>().value_or(NAN));
    } else {
      out.push_back(row.value<double>().value_or(NAN));
    }
    if (out.size() > kMaxTomlNumbers) return {};
  }
  return out;
}

Result<ImportedCamera> tomlCamera(const std::string& key, const toml::table& table, const std::string& path) {
  ImportedCamera out;
  PinholeCamera& pinhole = out.camera.pinhole;
  pinhole.name = table["name"].value_or(key);
  const std::string where = path + ": [" + key + "]";
  const auto size = tomlNumbers(table, "size"), rotation = tomlNumbers(table, "rotation");
  const auto translation = tomlNumbers(table, "translation"), coefficients = tomlNumbers(table, "distortions");
  if (size.size() == 2 && size[0] >= 1 && size[1] >= 1 && size[0] < 1e6 && size[1] < 1e6)
    pinhole.width = static_cast<int>(size[0]), pinhole.height = static_cast<int>(size[1]);
  const bool complete = (rotation.size() == 3 || rotation.size() == 9) && translation.size() == 3;
  if (!complete || (coefficients.empty() && table.contains("distortions"))) {
    return Error{ErrorId::CameraPose, where + ": needs rotation (three or nine numbers), translation (three) and " +
                                          "distortions (a list); export the calibration again"};
  }
  const bool fisheye = table["fisheye"].value_or(false);
  FOURDVT_ASSIGN(out.camera.distortion, distortionOf(coefficients, fisheye, where));
  const auto matrix = tomlNumbers(table, "matrix");
  if (matrix.size() != 9)
    return Error{ErrorId::CameraPose, where + ": matrix must have nine numbers" + tooManyNumbers(matrix.size(), 9) +
                                          "; export the calibration again"};
  FOURDVT_TRY(setCameraMatrix(matrix, kFirstPixelAtZero, out.camera, where));
  const glm::dmat3 turned =
      rotation.size() == 9 ? rowByRow(rotation) : rotationOf({rotation[0], rotation[1], rotation[2]});
  FOURDVT_TRY(setPose(turned, {translation[0], translation[1], translation[2]}, out.camera, where));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

}  // namespace

Result<ImportedCalibration> parseToml(const std::string& text, const std::string& path) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const int line = static_cast<int>(error.source().begin.line);
    return Error{ErrorId::FileUnreadable, atLine(path, line) + "not valid TOML (" + std::string(error.description()) +
                                              "); export the calibration again"};
  }
  ImportedCalibration out{"Pose2Sim or Caliscope", path, {}, 1, WorldAxis::Z};
  for (const auto& [key, node] : root) {
    const toml::table* table = node.as_table();
    if (!table || !table->contains("matrix")) continue;
    FOURDVT_ASSIGN(out.cameras.emplace_back(), tomlCamera(std::string(key.str()), *table, path));
  }
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable, path + ": no table with \"matrix\", which a camera has; export a calibration"};
}

}  // namespace fourdvt::capture
