// SPDX-License-Identifier: Apache-2.0
// COLMAP's text model: cameras.txt (intrinsics) and images.txt (poses, world to camera).
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <set>

#include "capture/capture.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr int kMaxSide = 32768;  // pixels

struct Intrinsics {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Distortion distortion;
};

struct Model {
  std::string_view name;
  int parameters;
  Intrinsics (*make)(const double* p);
};

constexpr std::array<Model, 5> kModels{{
    {"SIMPLE_PINHOLE", 3, [](const double* p) { return Intrinsics{0, 0, p[0], p[0], p[1], p[2], {}}; }},
    {"PINHOLE", 4, [](const double* p) { return Intrinsics{0, 0, p[0], p[1], p[2], p[3], {}}; }},
    {"SIMPLE_RADIAL", 4,
     [](const double* p) {
       return Intrinsics{0, 0, p[0], p[0], p[1], p[2], {p[3], 0, 0, 0}};
     }},
    {"RADIAL", 5,
     [](const double* p) {
       return Intrinsics{0, 0, p[0], p[0], p[1], p[2], {p[3], p[4], 0, 0}};
     }},
    {"OPENCV", 8,
     [](const double* p) {
       return Intrinsics{0, 0, p[0], p[1], p[2], p[3], {p[4], p[5], p[6], p[7]}};
     }},
}};

std::string at(const std::string& file, int line) { return file + ":" + std::to_string(line) + ": "; }

Error poseError(const std::string& where, const std::string& what) {
  return {ErrorId::CameraPose, where + what + "; export the calibration again"};
}

bool sane(const Intrinsics& i) {
  const Distortion& d = i.distortion;
  for (double v : {i.fx, i.fy, i.cx, i.cy, d.k1, d.k2, d.p1, d.p2}) {
    if (!std::isfinite(v)) return false;
  }
  return i.fx > 0 && i.fy > 0;
}

Result<Intrinsics> parseModel(std::string_view line, const std::string& where) {
  const std::string name(takeWord(line));
  const Model* model = nullptr;
  for (const Model& candidate : kModels) {
    if (candidate.name == name) model = &candidate;
  }
  if (!model) {
    return Error{ErrorId::CameraModel, where + "camera model \"" + name +
                                           "\" is not supported; undistort to PINHOLE, or use SIMPLE_RADIAL or OPENCV"};
  }
  const auto width = toNumber<int>(takeWord(line)), height = toNumber<int>(takeWord(line));
  if (!width || !height || *width < 1 || *height < 1 || *width > kMaxSide || *height > kMaxSide) {
    return poseError(where, "width and height must be 1 to 32768 pixels");
  }
  std::array<double, 8> parameters{};
  for (int i = 0; i < model->parameters; ++i) {
    const auto value = toNumber<double>(takeWord(line));
    if (!value) return poseError(where, name + " needs " + std::to_string(model->parameters) + " numbers");
    parameters[i] = *value;
  }
  Intrinsics intrinsics = model->make(parameters.data());
  intrinsics.width = *width;
  intrinsics.height = *height;
  if (!sane(intrinsics)) return poseError(where, "focal lengths must be positive and all numbers finite");
  return intrinsics;
}

Result<std::map<int64_t, Intrinsics>> parseCameras(std::string_view text, const std::string& file) {
  std::map<int64_t, Intrinsics> cameras;
  std::string_view line;
  for (int number = 1; takeLine(text, line); ++number) {
    const std::string_view first = takeWord(line);
    if (first.empty() || first.front() == '#') continue;
    const auto id = toNumber<int64_t>(first);
    if (!id) return poseError(at(file, number), "the line must start with a camera number");
    FOURDVT_ASSIGN(cameras[*id], parseModel(line, at(file, number)));
  }
  if (cameras.empty()) return poseError(file + ": ", "no camera in it");
  return cameras;
}

// "cam00.png" and "cam00/000000.png" both name camera "cam00".
std::string cameraName(std::string_view image_name) {
  const std::string_view head = image_name.substr(0, image_name.find('/'));
  return std::string(head.size() < image_name.size() ? head : head.substr(0, head.rfind('.')));
}

// One image line behind its number: QW QX QY QZ TX TY TZ CAMERA_ID NAME.
Result<CaptureCamera> parseImage(std::string_view line, const std::map<int64_t, Intrinsics>& cameras,
                                 const std::string& where) {
  std::array<double, 7> pose{};
  for (double& value : pose) {
    const auto number = toNumber<double>(takeWord(line));
    if (!number || !std::isfinite(*number)) {
      return poseError(where, "the pose must be seven finite numbers (QW QX QY QZ TX TY TZ)");
    }
    value = *number;
  }
  glm::dquat rotation(pose[0], pose[1], pose[2], pose[3]);
  if (!(glm::length(rotation) > 1e-6) || !std::isfinite(glm::length(rotation))) {
    return poseError(where, "the rotation quaternion has no length, so the pose is singular");
  }
  const auto id = toNumber<int64_t>(takeWord(line));
  const auto found = id ? cameras.find(*id) : cameras.end();
  if (found == cameras.end()) return poseError(where, "the image refers to a camera that cameras.txt does not list");
  const Intrinsics& k = found->second;
  CaptureCamera camera;
  camera.pinhole = {cameraName(takeWord(line)), k.width, k.height, k.fx, k.fy, k.cx, k.cy};
  camera.pinhole.cam_from_world = glm::dmat4(glm::mat3_cast(glm::normalize(rotation)));
  camera.pinhole.cam_from_world[3] = glm::dvec4(pose[4], pose[5], pose[6], 1);
  camera.distortion = k.distortion;
  const std::string& name = camera.pinhole.name;
  if (name.empty()) return poseError(where, "the image has no name");
  if (name == "." || name == "..") return poseError(where, "an image called " + name + " cannot name a camera's files");
  return camera;
}

// A POINTS2D line holds triples; an image line holds ten words.
bool isPointsLine(std::string_view line) {
  size_t words = 0;
  while (!takeWord(line).empty()) ++words;
  return words % 3 == 0;
}

}  // namespace

Result<std::vector<CaptureCamera>> parseColmapText(std::string_view cameras_text, std::string_view images_text,
                                                   const std::string& path) {
  FOURDVT_ASSIGN(auto intrinsics, parseCameras(cameras_text, path + "/cameras.txt"));
  const std::string file = path + "/images.txt";
  std::vector<CaptureCamera> cameras;
  std::set<std::string> names;
  bool after_image = false;
  std::string_view line;
  for (int number = 1; takeLine(images_text, line); ++number) {
    const bool points = after_image && isPointsLine(line);
    after_image = false;
    const std::string_view first = takeWord(line);
    if (points || first.empty() || first.front() == '#') continue;
    if (!toNumber<int64_t>(first)) return poseError(at(file, number), "the line must start with an image number");
    auto camera = parseImage(line, intrinsics, at(file, number));
    if (!camera.ok()) return camera.error();
    if (!names.insert(camera.value().pinhole.name).second) {
      return poseError(at(file, number), "camera \"" + camera.value().pinhole.name + "\" is listed twice");
    }
    cameras.push_back(camera.take());
    after_image = true;
  }
  if (cameras.empty()) return poseError(file + ": ", "no image in it");
  return cameras;
}

Result<std::vector<CaptureCamera>> readColmapCameras(const std::string& folder) {
  std::array<std::string, 2> texts;
  const char* names[] = {"/cameras.txt", "/images.txt"};
  for (int i = 0; i < 2; ++i) {
    auto text = readText(folder + names[i]);
    if (!text) {
      return Error{ErrorId::FileMissing,
                   folder + names[i] + ": cannot be read; export the calibration as a COLMAP text model"};
    }
    texts[i] = std::move(*text);
  }
  return parseColmapText(texts[0], texts[1], folder);
}

void scaleToMetres(std::vector<CaptureCamera>& cameras, double metres_per_unit) {
  for (CaptureCamera& camera : cameras) {
    glm::dvec4& translation = camera.pinhole.cam_from_world[3];
    translation = glm::dvec4(glm::dvec3(translation) * metres_per_unit, 1);
  }
}

ColmapText colmapText(const std::vector<CaptureCamera>& cameras, double metres_per_unit) {
  ColmapText out{"# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[] (PINHOLE: fx fy cx cy; OPENCV: and k1 k2 p1 p2)\n",
                 "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME / POINTS2D[] (empty)\n"};
  char line[400];
  for (size_t c = 0; c < cameras.size(); ++c) {
    const PinholeCamera& p = cameras[c].pinhole;
    const Distortion& d = cameras[c].distortion;
    const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(p.cam_from_world)));
    const glm::dvec3 t = glm::dvec3(p.cam_from_world[3]) / metres_per_unit;
    std::snprintf(line, sizeof line, "%zu %s %d %d %.9f %.9f %.9f %.9f", c + 1, d.any() ? "OPENCV" : "PINHOLE", p.width,
                  p.height, p.fx, p.fy, p.cx, p.cy);
    out.cameras += line;
    if (d.any()) {
      std::snprintf(line, sizeof line, " %.12g %.12g %.12g %.12g", d.k1, d.k2, d.p1, d.p2);
      out.cameras += line;
    }
    out.cameras += "\n";
    std::snprintf(line, sizeof line, "%zu %.15f %.15f %.15f %.15f %.12f %.12f %.12f %zu ", c + 1, q.w, q.x, q.y, q.z,
                  t.x, t.y, t.z, c + 1);
    out.images += line + p.name + "\n\n";
  }
  return out;
}

}  // namespace fourdvt::capture
