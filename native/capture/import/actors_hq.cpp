// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>

#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr std::array<const char*, 12> kColumns{"w", "h", "rx", "ry", "rz", "tx", "ty", "tz", "fx", "fy", "px", "py"};

std::vector<std::string> cellsOf(std::string_view line) {
  std::vector<std::string> out;
  while (true) {
    const size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    std::string_view rest = cell;
    out.emplace_back(takeWord(rest));
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

Result<ImportedCamera> actorsHqCamera(std::map<std::string, std::string>& row, const std::string& where) {
  std::map<std::string, double> values;
  for (const char* column : kColumns) {
    const auto value = toNumber<double>(row[column]);
    if (!value) {
      return Error{ErrorId::CameraPose,
                   where + ": column " + column + " must hold a number; export the calibration again"};
    }
    values[column] = *value;
  }
  ImportedCamera out;
  PinholeCamera& p = out.camera.pinhole;
  p.name = row["name"];
  const double width = values["w"], height = values["h"];
  p.width = width >= 1 && width < 1e6 ? static_cast<int>(width) : -1;
  p.height = height >= 1 && height < 1e6 ? static_cast<int>(height) : -1;
  p.fx = values["fx"] * width;
  p.fy = values["fy"] * height;
  p.cx = values["px"] * width;
  p.cy = values["py"] * height;
  const glm::dmat3 rotation = glm::transpose(rotationOf({values["rx"], values["ry"], values["rz"]}));
  const glm::dvec3 position(values["tx"], values["ty"], values["tz"]);
  FOURDVT_TRY(setPose(rotation, -(rotation * position), out.camera, where));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

}  // namespace

Result<ImportedCalibration> parseActorsHq(const std::string& text, const std::string& path) {
  std::string_view rest = text, line;
  takeLine(rest, line);
  const std::vector<std::string> header = cellsOf(line);
  ImportedCalibration out{"ActorsHQ", path, {}, 1, {}};
  for (int number = 2; takeLine(rest, line); ++number) {
    const std::vector<std::string> cells = cellsOf(line);
    if (cells.size() == 1 && cells[0].empty()) continue;
    std::map<std::string, std::string> row;
    for (size_t i = 0; i < std::min(cells.size(), header.size()); ++i) row[header[i]] = cells[i];
    FOURDVT_ASSIGN(out.cameras.emplace_back(), actorsHqCamera(row, path + ":" + std::to_string(number)));
  }
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable,
               path + ": no camera below the line name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py; export it again"};
}

}  // namespace fourdvt::capture
