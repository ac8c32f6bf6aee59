// SPDX-License-Identifier: Apache-2.0
// RealityCapture: focal length and principal point refer to a picture whose longer side is 36 mm; radial coefficients
// are Brown's, for r² to r⁸. The table has the camera's position and angles in degrees: world from camera (x right, y
// up, z back) is Rz(-heading) Rx(pitch) Ry(roll). XMP files have world to camera (x right, y down, z forward) row by
// row.
#include <cmath>

#include "capture/import/camera_numbers.h"
#include "capture/import/csv.h"
#include "capture/import/imported.h"
#include "capture/import/readers.h"
#include "capture/import/xml.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr double kFilm = 36, kWorstFit_focals = 1e-4;  // millimetres; focal lengths
const double kRadians = std::acos(-1.0) / 180;

// `focal` and `principal`: in longer sides.
Status setRealityLens(double focal, const glm::dvec2& principal, const Brown4& lens, const std::string& where,
                      ImportedCamera& out) {
  if (!(focal > 0))
    return Error{ErrorId::CameraPose, where + "the focal length must be positive; export the calibration again"};
  RelativeLens& relative = out.relative.emplace();
  relative.unit = RelativeLens::Unit::LongerSide;
  relative.focal = focal;
  relative.principal = principal;
  const LensFit fit = fitBrown4(lens, std::sqrt(0.5) / focal);
  if (!(fit.residual <= kWorstFit_focals)) {
    return Error{ErrorId::CameraModel,
                 where + "k4 cannot be expressed in OpenCV's model; align the pictures with the model Brown3"};
  }
  out.camera.distortion = fit.distortion;
  out.camera.pinhole.fx = out.camera.pinhole.fy = 1;
  return {};
}

glm::dmat3 turn(int axis, double degrees) {
  glm::dvec3 vector(0);
  vector[axis] = degrees * kRadians;
  return rotationOf(vector);
}

Result<ImportedCamera> csvCamera(const CsvTable::Row& row) {
  ImportedCamera out;
  const std::string file = row.cells.at("#name"), where = row.where.substr(0, row.where.size() - 2);
  out.camera.pinhole.name = file.substr(0, file.rfind('.'));
  out.listed = file;
  glm::dvec3 centre, angles;
  const char *places[] = {"x", "y", "alt"}, *turns[] = {"pitch", "roll", "heading"};
  for (int i = 0; i < 3; ++i) {
    FOURDVT_ASSIGN(centre[i], row.number(places[i]));
    FOURDVT_ASSIGN(angles[i], row.number(turns[i]));
  }
  glm::dmat3 axes = turn(2, -angles[2]) * turn(0, angles[0]) * turn(1, angles[1]);
  axes[1] = -axes[1];
  axes[2] = -axes[2];
  const glm::dmat3 rotation = glm::transpose(axes);
  FOURDVT_TRY(setPose(rotation, -(rotation * centre), out.camera, where));
  std::map<std::string, double> n;
  FOURDVT_ASSIGN(n["f"], row.number("f"));
  for (const char* name : {"px", "py", "k1", "k2", "k3", "k4", "t1", "t2"}) {
    FOURDVT_ASSIGN(n[name], row.orZero(name));
  }
  FOURDVT_TRY(setRealityLens(n["f"] / kFilm, {n["px"] / kFilm, n["py"] / kFilm},
                             {n["k1"], n["k2"], n["k3"], n["k4"], n["t1"], n["t2"]}, row.where, out));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

// Attribute "xcr:NAME" of the description, or the text of its child of that name.
std::string xcr(const pugi::xml_node& description, const char* name) {
  const std::string whole = std::string("xcr:") + name;
  if (const auto attribute = description.attribute(whole.c_str())) return attribute.as_string();
  return description.child_value(whole.c_str());
}

Result<double> xcrNumber(const pugi::xml_node& description, const char* name, const std::string& where) {
  const std::string text = xcr(description, name);
  if (text.empty()) return 0.0;
  FOURDVT_ASSIGN(const auto values, xmlNumbers(text.c_str(), 1, where + "xcr:" + name));
  return values[0];
}

Status setXmpLens(const pugi::xml_node& description, const std::string& where, ImportedCamera& out) {
  FOURDVT_ASSIGN(const double focal, xcrNumber(description, "FocalLength35mm", where));
  FOURDVT_ASSIGN(const double u, xcrNumber(description, "PrincipalPointU", where));
  FOURDVT_ASSIGN(const double v, xcrNumber(description, "PrincipalPointV", where));
  FOURDVT_ASSIGN(const double skew, xcrNumber(description, "Skew", where));
  const std::string model = xcr(description, "DistortionModel"), given = xcr(description, "DistortionCoeficients");
  Brown4 lens;
  if (!given.empty()) {
    FOURDVT_ASSIGN(const auto k, xmlNumbers(given.c_str(), 6, where + "xcr:DistortionCoeficients"));
    lens = {k[0], k[1], k[2], k[3], k[4], k[5]};
    const bool bent = std::any_of(k.begin(), k.end(), [](double value) { return value != 0; });
    if (bent && !model.starts_with("brown")) {
      return Error{ErrorId::CameraModel, where + "distortion model \"" + model +
                                             "\" is not read; align the pictures with the model Brown3 or Brown3 with "
                                             "tangential2"};
    }
  }
  if (skew != 0) return Error{ErrorId::CameraModel, where + "skew is not read; align the pictures without it"};
  return setRealityLens(focal / kFilm, {u, v}, lens, where, out);
}

}  // namespace

Result<ImportedCalibration> parseRealityCaptureCsv(const std::string& text, const std::string& path) {
  FOURDVT_ASSIGN(const CsvTable table, parseCsv(text, path));
  ImportedCalibration out{"RealityCapture", path, {}, {}, WorldAxis::Z, {}, {}};
  if (!table.has({"#name", "x", "y", "alt", "heading", "pitch", "roll", "f"})) {
    return Error{ErrorId::FileUnreadable, path +
                                              ": no line #name,x,y,alt,heading,pitch,roll,f,px,py,…; export "
                                              "\"Internal/External camera parameters\""};
  }
  for (const CsvTable::Row& row : table.rows) {
    if (!row.cells.count("#name") || row.cells.at("#name").empty()) continue;
    FOURDVT_ASSIGN(out.cameras.emplace_back(), csvCamera(row));
  }
  KeyNotes notes(
      {"#name", "x", "y", "alt", "heading", "pitch", "roll", "f", "px", "py", "k1", "k2", "k3", "k4", "t1", "t2"}, {});
  for (const std::string& column : table.columns) notes.see(column);
  notes.finish(out);
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable, path + ": no camera below its first line; export the calibration again"};
}

bool looksLikeRealityCaptureXmp(const std::string& text) {
  return text.find("capturingreality.com") != text.npos && text.find("xcr:Rotation") != text.npos;
}

Result<ImportedCamera> parseRealityCaptureXmp(const std::string& text, const std::string& name,
                                              const std::string& path) {
  pugi::xml_document document;
  FOURDVT_TRY(loadXml(text, path, document));
  const pugi::xml_node description =
      document.find_node([](const pugi::xml_node& node) { return std::string_view(node.name()) == "rdf:Description"; });
  const std::string where = path + ": ";
  ImportedCamera out;
  out.camera.pinhole.name = name;
  FOURDVT_ASSIGN(const auto r, xmlNumbers(xcr(description, "Rotation").c_str(), 9, where + "xcr:Rotation"));
  FOURDVT_ASSIGN(const auto c, xmlNumbers(xcr(description, "Position").c_str(), 3, where + "xcr:Position"));
  const glm::dmat3 rotation = rowByRow(r);
  FOURDVT_TRY(setPose(rotation, -(rotation * glm::dvec3(c[0], c[1], c[2])), out.camera, path));
  FOURDVT_TRY(setXmpLens(description, where, out));
  FOURDVT_TRY(checkCameraNumbers(out.camera, path));
  return out;
}

}  // namespace fourdvt::capture
