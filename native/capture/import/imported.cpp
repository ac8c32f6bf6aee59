// SPDX-License-Identifier: Apache-2.0
#include "capture/import/imported.h"

#include <algorithm>
#include <array>

namespace fourdvt::capture {
namespace {

constexpr std::array<const char*, 6> kAxisNames{"X", "-X", "Y", "-Y", "Z", "-Z"};

constexpr size_t kMaxNamed = 40;  // keys per line

std::string listOf(const std::set<std::string>& keys) {
  std::string out;
  size_t named = 0;
  for (const std::string& key : keys) {
    if (++named > kMaxNamed) return out + " and " + std::to_string(keys.size() - kMaxNamed) + " more";
    out += (out.empty() ? "" : ", ") + key;
  }
  return out;
}

}  // namespace

const char* axisName(WorldAxis axis) { return kAxisNames[static_cast<size_t>(axis)]; }

std::optional<WorldAxis> axisNamed(std::string_view name) {
  for (size_t i = 0; i < kAxisNames.size(); ++i)
    if (name == kAxisNames[i]) return static_cast<WorldAxis>(i);
  return std::nullopt;
}

void setLens(const RelativeLens& lens, PinholeCamera& camera) {
  const int longer = std::max(camera.width, camera.height);
  const double unit = lens.unit == RelativeLens::Unit::Width ? camera.width : longer;
  if (lens.focal > 0) camera.fx = camera.fy = lens.focal * unit;
  if (lens.focal_y > 0) camera.fy = lens.focal_y * camera.height;
  if (!lens.principal) return;
  camera.cx = camera.width / 2.0 + lens.principal->x * unit;
  camera.cy = camera.height / 2.0 + lens.principal->y * unit;
}

std::string plainName(std::string name) {
  for (char& c : name)
    if (std::string_view(" \t()[]{}<>&;|,'\"?*#%$!`=+~^@:").find(c) != std::string_view::npos) c = '_';
  return name;
}

glm::dmat3 turnToY(WorldAxis up) {
  // Columns: images of x, y and z.
  switch (up) {
    case WorldAxis::X:
      return {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
    case WorldAxis::MinusX:
      return {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
    case WorldAxis::MinusY:
      return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    case WorldAxis::Z:
      return {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    case WorldAxis::MinusZ:
      return {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    case WorldAxis::Y:
      break;
  }
  return glm::dmat3(1);
}

void addListed(const std::vector<ListedCamera>& cameras, ImportedCalibration& out) {
  for (const ListedCamera& camera : cameras) out.cameras.push_back({camera.camera, {}, camera.pictures, {}, {}, {}});
}

void KeyNotes::see(const std::string& key) {
  if (read_.count(key)) return;
  (known_.count(key) ? not_read_ : unknown_).insert(key);
}

void KeyNotes::finish(ImportedCalibration& out) const {
  if (!not_read_.empty())
    out.warnings.push_back(out.path + ": not read: " + listOf(not_read_) + "; check that the cameras do not need it");
  if (!unknown_.empty()) out.details.push_back(out.path + ": unknown keys, passed over: " + listOf(unknown_));
}

}  // namespace fourdvt::capture
