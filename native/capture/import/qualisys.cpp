// SPDX-License-Identifier: Apache-2.0
// Qualisys .qca.txt: r11…r33 are the axes of the camera, which views along -z with y up, as rows; its position is in
// world coordinates.
#include <array>
#include <cmath>

#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/import/xml.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr double kPerPixel = 64;

// Reads attributes of one element, and keeps the error of the first missing or malformed one.
class Attributes {
 public:
  explicit Attributes(const pugi::xml_node& node) : node_(node) {}
  double operator[](const char* name) {
    const std::string word(trimmed(node_.attribute(name).as_string()));
    const auto value = toNumber<double>(word);
    const bool valid = value && std::isfinite(*value);
    if (!valid && problem_.empty())
      problem_ = "the attribute " + std::string(node_.name()) + " " + name +
                 (node_.attribute(name) ? ": " + numberProblem(word) : " is missing");
    return valid ? *value : 0;
  }
  double orZero(const char* name) { return node_.attribute(name) ? (*this)[name] : 0; }
  const std::string& problem() const { return problem_; }

 private:
  pugi::xml_node node_;
  std::string problem_;
};

// Sets the lens. The picture's size is its field of view's; pixels are counted from the field's top left.
void setQualisysLens(Attributes& field, Attributes& lens, CaptureCamera& camera) {
  const double left = field["left"], top = field["top"];
  PinholeCamera& p = camera.pinhole;
  const auto side = [](double pixels) { return std::abs(pixels) < 1e6 ? int(std::lround(pixels)) : -1; };
  p.width = side(field["right"] - left + 1);
  p.height = side(field["bottom"] - top + 1);
  p.fx = lens["focalLengthU"] / kPerPixel;
  p.fy = lens["focalLengthV"] / kPerPixel;
  p.cx = lens["centerPointU"] / kPerPixel - left + kFirstPixelAtZero;
  p.cy = lens["centerPointV"] / kPerPixel - top + kFirstPixelAtZero;
  camera.distortion = {lens["radialDistortion1"], lens["radialDistortion2"], lens["tangentalDistortion1"],
                       lens["tangentalDistortion2"], lens.orZero("radialDistortion3")};
  camera.distortion.skew = lens.orZero("skew") / kPerPixel;
}

Status setQualisysPose(Attributes& pose, CaptureCamera& camera, const std::string& where) {
  std::array<double, 9> rows{};
  const char* names[] = {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"};
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = pose[names[i]] * (i < 3 ? 1 : -1);  // y down, z forward
  const glm::dmat3 rotation = rowByRow(rows);
  return setPose(rotation, -(rotation * glm::dvec3(pose["x"], pose["y"], pose["z"])), camera, where);
}

Result<ImportedCamera> qualisysCamera(const pugi::xml_node& node, const std::string& text, const std::string& path) {
  ImportedCamera out;
  out.camera.pinhole.name = node.attribute("serial").as_string();
  const std::string where = placeOf(node, text, path) + "camera " + out.camera.pinhole.name;
  Attributes field(node.child("fov_video") ? node.child("fov_video") : node.child("fov_marker"));
  Attributes lens(node.child("intrinsic")), pose(node.child("transform"));
  setQualisysLens(field, lens, out.camera);
  const Status posed = setQualisysPose(pose, out.camera, where);
  for (const Attributes* attributes : {&field, &lens, &pose}) {
    if (attributes->problem().empty()) continue;
    return badCalibration(where, attributes->problem());
  }
  FOURDVT_TRY(posed);
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

}  // namespace

Result<ImportedCalibration> parseQualisys(const std::string& text, const std::string& path) {
  pugi::xml_document document;
  FOURDVT_TRY(loadXml(text, path, document));
  ImportedCalibration out{"Qualisys", path, {}, 0.001, WorldAxis::Z, {}, {}};
  for (const pugi::xml_node& node : document.child("calibration").child("cameras").children("camera")) {
    FOURDVT_ASSIGN(out.cameras.emplace_back(), qualisysCamera(node, text, path));
  }
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable, path +
                                            ": no <camera> in <calibration>, <cameras>; export a camera "
                                            "calibration from Qualisys Track Manager"};
}

}  // namespace fourdvt::capture
