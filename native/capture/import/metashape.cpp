// SPDX-License-Identifier: Apache-2.0
// Agisoft Metashape's camera export. With x = X/Z, y = Y/Z (for a fisheye (x, y) atan(r)/r), r² = x² + y² the manual
// defines
//    x' = x (1 + K1 r² + K2 r⁴ + K3 r⁶ + K4 r⁸) + P1 (r² + 2 x²) + 2 P2 x y, y' alike with P1 and P2 exchanged,
//    u = w/2 + cx + x' f + x' B1 + y' B2, v = h/2 + cy + y' f; the first pixel's centre is at 0.5.
#include <cmath>
#include <map>

#include "capture/camera_names.h"
#include "capture/import/camera_numbers.h"
#include "capture/import/imported.h"
#include "capture/import/readers.h"
#include "capture/import/xml.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr double kWorstFit_px = 0.1;

Error badMetashape(const std::string& where, const std::string& what, ErrorId id = ErrorId::CameraPose) {
  return {id, where + what + "; export the cameras again"};
}

class MetashapeReader {
 public:
  MetashapeReader(const std::string& text, const std::string& path) : text_(text), path_(path) {}

  Result<ImportedCalibration> read() {
    pugi::xml_document document;
    FOURDVT_TRY(loadXml(text_, path_, document));
    const pugi::xml_node chunk = document.child("document").child("chunk");
    out_ = {"Metashape", path_, {}, {}, {}, {}, {}};
    for (const pugi::xml_node& sensor : chunk.child("sensors").children("sensor")) FOURDVT_TRY(addSensor(sensor));
    FOURDVT_TRY(readWorld(chunk));
    FOURDVT_TRY(addCameras(chunk.child("cameras"), ""));
    if (pictures_.empty())
      return badMetashape(path_ + ": ", "no camera with a pose in it: align the photos first", ErrorId::FileUnreadable);
    FOURDVT_ASSIGN(const auto cameras, camerasOfPictures(pictures_));
    addListed(cameras, out_);
    if (!left_out_.empty())
      out_.warnings.push_back(path_ + ": cameras without a pose, or not enabled, are left out: " + left_out_);
    notes_.finish(out_);
    return std::move(out_);
  }

 private:
  Result<double> number(const pugi::xml_node& node, const char* name, const std::string& where) {
    const pugi::xml_node child = node.child(name);
    if (!child) return 0.0;
    FOURDVT_ASSIGN(const auto values, xmlNumbers(child.child_value(), 1, where + "<" + name + ">"));
    return values[0];
  }

  Status addSensor(const pugi::xml_node& sensor) {
    const std::string where = placeOf(sensor, text_, path_);
    pugi::xml_node lens;  // the adjusted one if there are two
    for (const pugi::xml_node& one : sensor.children("calibration"))
      if (!lens || std::string(one.attribute("class").as_string()) == "adjusted") lens = one;
    if (!lens) return {};  // sensor without photos
    const std::string type = lens.attribute("type").as_string(sensor.attribute("type").as_string("frame"));
    if (type != "frame" && type != "fisheye" && type != "equidistant_fisheye") {
      return Error{ErrorId::CameraModel, where + "sensors of type \"" + type +
                                             "\" are not read; calibrate as frame or (equidistant) fisheye"};
    }
    std::map<std::string, double> n;
    for (const char* name :
         {"f", "fx", "fy", "cx", "cy", "b1", "b2", "skew", "k1", "k2", "k3", "k4", "p1", "p2", "p3", "p4"}) {
      FOURDVT_ASSIGN(n[name], number(lens, name, where));
    }
    if (n["p3"] != 0 || n["p4"] != 0)
      return Error{ErrorId::CameraModel, where + "P3 and P4 are not read; optimise the cameras without them"};
    const pugi::xml_node size = lens.child("resolution") ? lens.child("resolution") : sensor.child("resolution");
    CaptureCamera& camera = sensors_[sensor.attribute("id").as_string()];
    PinholeCamera& p = camera.pinhole;
    p.width = size.attribute("width").as_int();
    p.height = size.attribute("height").as_int();
    if (p.width < 1 || p.height < 1) {
      return Error{ErrorId::CameraModel, where +
                                             "the sensor has no <resolution>, from whose middle its principal point "
                                             "counts; export the cameras again"};
    }
    p.fx = n["f"] != 0 ? n["f"] + n["b1"] : n["fx"];
    p.fy = n["f"] != 0 ? n["f"] : n["fy"];
    // Before version 1.3, <fx> and <fy> came with a principal point in pixels.
    p.cx = n["f"] != 0 ? p.width / 2.0 + n["cx"] : n["cx"];
    p.cy = n["f"] != 0 ? p.height / 2.0 + n["cy"] : n["cy"];
    for (const pugi::xml_node& child : lens.children())
      if (child.type() == pugi::node_element) notes_.see(child.name());
    return setMetashapeLens(n, type != "frame", where, camera);
  }

  // Sets the lens. Metashape's P1 is OpenCV's p2.
  Status setMetashapeLens(std::map<std::string, double>& n, bool fisheye, const std::string& where,
                          CaptureCamera& camera) {
    const PinholeCamera& p = camera.pinhole;
    if (fisheye) {
      camera.distortion = {
          .k1 = n["k1"], .k2 = n["k2"], .p1 = n["p2"], .p2 = n["p1"], .k3 = n["k3"], .k4 = n["k4"], .fisheye = true};
    } else {
      const double radius = p.fx > 0 ? std::hypot(p.width, p.height) / 2 / p.fx : 1;
      const LensFit fit = fitBrown4({n["k1"], n["k2"], n["k3"], n["k4"], n["p2"], n["p1"]}, radius);
      if (!(fit.residual * p.fx <= kWorstFit_px)) {
        return Error{ErrorId::CameraModel, where +
                                               "K4 cannot be expressed in OpenCV's model within 0.1 pixels; optimise "
                                               "the cameras without K4"};
      }
      if (n["k4"] != 0)
        out_.details.push_back(where + "K4 is expressed in OpenCV's model within " +
                               std::to_string(fit.residual * p.fx) + " pixels");
      camera.distortion = fit.distortion;
    }
    camera.distortion.skew = n["b2"] + n["skew"];
    return checkCameraNumbers(camera, where.substr(0, where.size() - 2));
  }

  // Reads the transform of the chunk, or of its first component with one.
  Status readWorld(const pugi::xml_node& chunk) {
    pugi::xml_node transform = chunk.child("transform");
    for (const pugi::xml_node& component : chunk.child("components").children("component"))
      if (!transform) transform = component.child("transform");
    if (!transform) return {};
    const std::string where = placeOf(transform, text_, path_);
    const std::string system = chunk.child("reference").child_value();
    FOURDVT_ASSIGN(scale_, number(transform, "scale", where));
    if (!(scale_ > 0)) scale_ = 1;
    out_.metres_per_unit = 1;
    if (!system.empty() && !system.starts_with("LOCAL_CS")) {
      out_.warnings.push_back(path_ +
                              ": its coordinate system is one of the earth: only the scale of its transform is "
                              "used; choose local coordinates in Metashape, or give --up");
      return {};
    }
    if (transform.child("rotation")) {
      FOURDVT_ASSIGN(const auto r, xmlNumbers(transform.child_value("rotation"), 9, where + "<rotation>"));
      rotation_ = rowByRow(r);
    }
    if (transform.child("translation")) {
      FOURDVT_ASSIGN(const auto t, xmlNumbers(transform.child_value("translation"), 3, where + "<translation>"));
      translation_ = {t[0], t[1], t[2]};
    }
    out_.up = WorldAxis::Z;
    return {};
  }

  // Adds cameras; groups of cameras become folders of their names.
  Status addCameras(const pugi::xml_node& list, const std::string& folder, int depth = 0) {
    constexpr int kMaxDepth = 64;
    if (depth > kMaxDepth) {
      return Error{ErrorId::CameraPose,
                   placeOf(list, text_, path_) + "groups are nested deeper than 64; move the cameras out of them"};
    }
    for (const pugi::xml_node& group : list.children("group"))
      FOURDVT_TRY(addCameras(group, folder + group.attribute("label").as_string() + "/", depth + 1));
    for (const pugi::xml_node& node : list.children("camera")) {
      const std::string label = folder + node.attribute("label").as_string(),
                        enabled = node.attribute("enabled").as_string("1");
      if (!node.child("transform") || enabled == "0" || enabled == "false") {
        left_out_ += (left_out_.empty() ? "" : ", ") + label;
        continue;
      }
      FOURDVT_TRY(addCamera(node, label));
    }
    return {};
  }

  Status addCamera(const pugi::xml_node& node, const std::string& label) {
    const std::string where = placeOf(node, text_, path_);
    const auto sensor = sensors_.find(node.attribute("sensor_id").as_string());
    if (sensor == sensors_.end()) return badMetashape(where, "the camera's sensor has no calibration");
    FOURDVT_ASSIGN(const auto m, xmlNumbers(node.child_value("transform"), 16, where + "<transform>"));
    ListedPicture picture{sensor->second, label, where};
    const glm::dmat3 world_from_cam =
        rotation_ * glm::dmat3({m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]});
    const glm::dvec3 centre = rotation_ * (scale_ * glm::dvec3(m[3], m[7], m[11])) + translation_;
    const glm::dmat3 turned = glm::transpose(world_from_cam);
    FOURDVT_TRY(setPose(turned, -(turned * centre), picture.camera, where.substr(0, where.size() - 2)));
    pictures_.push_back(std::move(picture));
    return {};
  }

  const std::string& text_;
  const std::string& path_;
  ImportedCalibration out_;
  KeyNotes notes_{
      {"resolution", "f", "fx", "fy", "cx", "cy", "b1", "b2", "skew", "k1", "k2", "k3", "k4", "p1", "p2", "p3", "p4"},
      {"rolling_shutter"}};
  std::map<std::string, CaptureCamera> sensors_;
  std::vector<ListedPicture> pictures_;
  std::string left_out_;
  double scale_ = 1;
  glm::dmat3 rotation_{1};
  glm::dvec3 translation_{0};
};

}  // namespace

bool looksLikeMetashape(const std::string& text) {
  return text.find("<document") != text.npos && text.find("<chunk") != text.npos && text.find("<camera") != text.npos;
}

Result<ImportedCalibration> parseMetashape(const std::string& text, const std::string& path) {
  return MetashapeReader(text, path).read();
}

}  // namespace fourdvt::capture
