// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>

#include "capture/import/camera_numbers.h"
#include "capture/import/csv.h"
#include "capture/import/readers.h"

namespace fourdvt::capture {
namespace {

constexpr std::array<const char*, 12> kColumns{"w", "h", "rx", "ry", "rz", "tx", "ty", "tz", "fx", "fy", "px", "py"};

Result<ImportedCamera> actorsHqCamera(const CsvTable::Row& row) {
  std::map<std::string, double> values;
  for (const char* column : kColumns) {
    FOURDVT_ASSIGN(values[column], row.number(column));
  }
  ImportedCamera out;
  PinholeCamera& p = out.camera.pinhole;
  if (const auto name = row.cells.find("name"); name != row.cells.end()) p.name = name->second;
  const std::string where = row.where.substr(0, row.where.size() - 2);
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
  FOURDVT_ASSIGN(const CsvTable table, parseCsv(text, path));
  ImportedCalibration out{"ActorsHQ", path, {}, 1, {}, {}, {}};
  for (const CsvTable::Row& row : table.rows) {
    FOURDVT_ASSIGN(out.cameras.emplace_back(), actorsHqCamera(row));
  }
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable,
               path + ": no camera below the line name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py; export it again"};
}

}  // namespace fourdvt::capture
