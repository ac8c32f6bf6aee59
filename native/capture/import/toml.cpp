// SPDX-License-Identifier: Apache-2.0
#include <toml++/toml.h>

#include <cmath>

#include "capture/import/camera_numbers.h"
#include "capture/import/imported.h"
#include "capture/import/readers.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxTomlNumbers = 64;
const std::string kOfCaliscope = "cameras.";

// Numbers of an array, or of an array of arrays, row by row; empty for anything else.
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

// Candidate names of a camera's clips: Caliscope's, by number, and the stem of Pose2Sim's folder of lens pictures,
// "int_cam01_img".
std::vector<std::string> fileNamesOf(const std::string& key, const std::string& name) {
  if (key.starts_with(kOfCaliscope)) {
    const std::string number = key.substr(kOfCaliscope.size());
    std::vector<std::string> out{"port_" + number, "cam_" + number, "port" + number, "cam" + number, number};
    if (name != key) out.insert(out.begin(), name);
    return out;
  }
  std::string inner = name;
  if (inner.starts_with("int_")) inner = inner.substr(4);
  if (inner.ends_with("_img")) inner.resize(inner.size() - 4);
  if (inner == name || inner.empty()) return {};
  return {name, inner};
}

Result<ImportedCamera> tomlCamera(const std::string& key, const toml::table& table, const std::string& path) {
  ImportedCamera out;
  PinholeCamera& pinhole = out.camera.pinhole;
  const std::string name = table["name"].value_or(key);
  out.file_names = fileNamesOf(key, name);
  pinhole.name = out.file_names.empty() ? name : out.file_names.front();
  const std::string where = path + ": [" + key + "]";
  const auto size = tomlNumbers(table, "size"), rotation = tomlNumbers(table, "rotation");
  const auto translation = tomlNumbers(table, "translation"), coefficients = tomlNumbers(table, "distortions");
  if (size.size() == 2 && size[0] >= 1 && size[1] >= 1 && size[0] < 1e6 && size[1] < 1e6)
    pinhole.width = static_cast<int>(size[0]), pinhole.height = static_cast<int>(size[1]);
  const bool complete = (rotation.size() == 3 || rotation.size() == 9) && translation.size() == 3;
  if (!complete || (coefficients.empty() && table.contains("distortions"))) {
    return badCalibration(where,
                          "needs rotation (three or nine numbers), translation (three) and distortions (a list)");
  }
  const bool fisheye = table["fisheye"].value_or(false);
  FOURDVT_ASSIGN(out.camera.distortion, distortionOf(coefficients, fisheye, where));
  const auto matrix = tomlNumbers(table, "matrix");
  if (matrix.size() != 9)
    return badCalibration(where, "matrix must have nine numbers" + tooManyNumbers(matrix.size(), 9));
  FOURDVT_TRY(setCameraMatrix(matrix, kFirstPixelAtZero, out.camera, where));
  FOURDVT_TRY(
      setPose(rotationOfNumbers(rotation), {translation[0], translation[1], translation[2]}, out.camera, where));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

// Tables with a "matrix": at the top, or in Caliscope's "cameras", where their names are numbers.
std::vector<std::pair<std::string, const toml::table*>> cameraTables(const toml::table& root) {
  std::vector<std::pair<std::string, const toml::table*>> out;
  const auto add = [&](const toml::table& tables, const std::string& before) {
    for (const auto& [key, node] : tables)
      if (const toml::table* table = node.as_table(); table && table->contains("matrix"))
        out.emplace_back(before + std::string(key.str()), table);
  };
  add(root, "");
  if (const toml::table* cameras = root["cameras"].as_table()) add(*cameras, kOfCaliscope);
  return out;
}

// Returns true for Caliscope's cameras without a pose.
bool isUnposed(const std::string& key, const toml::table& table) {
  return key.starts_with(kOfCaliscope) && !table.contains("rotation") && !table.contains("translation");
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
  ImportedCalibration out{"Pose2Sim or Caliscope", path, {}, 1, WorldAxis::Z, {}, {}};
  KeyNotes notes(
      {"name", "size", "matrix", "distortions", "rotation", "translation", "fisheye", "port", "cam_id", "ignore"},
      {"skew", "tilt"});
  std::string left_out;
  for (const auto& [key, table] : cameraTables(root)) {
    for (const auto& [own, value] : *table) notes.see(std::string(own.str()));
    if ((*table)["ignore"].value_or(false) || isUnposed(key, *table)) {
      left_out += (left_out.empty() ? "" : ", ") + key;
      continue;
    }
    FOURDVT_ASSIGN(out.cameras.emplace_back(), tomlCamera(key, *table, path));
  }
  if (!left_out.empty())
    out.warnings.push_back(path + ": cameras without a pose, or to be ignored, are left out: " + left_out);
  notes.finish(out);
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable, path + ": no table with \"matrix\", which a camera has; export a calibration"};
}

}  // namespace fourdvt::capture
