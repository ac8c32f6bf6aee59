// SPDX-License-Identifier: Apache-2.0
#include "capture/colmap_model.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace fourdvt::capture {
namespace {

constexpr int kMaxSide = 32768;  // pixels

ColmapIntrinsics oneFocal(const double* p, const Distortion& d) { return {0, 0, p[0], p[0], p[1], p[2], d}; }
ColmapIntrinsics twoFocals(const double* p, const Distortion& d) { return {0, 0, p[0], p[1], p[2], p[3], d}; }

Distortion fisheye(double k1, double k2 = 0, double k3 = 0, double k4 = 0) {
  return {.k1 = k1, .k2 = k2, .k3 = k3, .k4 = k4, .fisheye = true};
}

constexpr std::array<ColmapModel, 9> kModels{{
    {0, "SIMPLE_PINHOLE", 3, [](const double* p) { return oneFocal(p, {}); }},
    {1, "PINHOLE", 4, [](const double* p) { return twoFocals(p, {}); }},
    {2, "SIMPLE_RADIAL", 4, [](const double* p) { return oneFocal(p, {p[3]}); }},
    {3, "RADIAL", 5,
     [](const double* p) {
       return oneFocal(p, {p[3], p[4]});
     }},
    {4, "OPENCV", 8,
     [](const double* p) {
       return twoFocals(p, {p[4], p[5], p[6], p[7]});
     }},
    {5, "OPENCV_FISHEYE", 8, [](const double* p) { return twoFocals(p, fisheye(p[4], p[5], p[6], p[7])); }},
    {6, "FULL_OPENCV", 12,
     [](const double* p) {
       return twoFocals(p, {p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11]});
     }},
    {8, "SIMPLE_RADIAL_FISHEYE", 4, [](const double* p) { return oneFocal(p, fisheye(p[3])); }},
    {9, "RADIAL_FISHEYE", 5, [](const double* p) { return oneFocal(p, fisheye(p[3], p[4])); }},
}};

bool saneIntrinsics(const ColmapIntrinsics& i) {
  const Distortion& d = i.distortion;
  for (double v : {i.fx, i.fy, i.cx, i.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6}) {
    if (!std::isfinite(v)) return false;
  }
  return i.fx > 0 && i.fy > 0;
}

std::string cameraNameOf(std::string_view image_name) {
  const std::string_view head = image_name.substr(0, image_name.find('/'));
  return std::string(head.size() < image_name.size() ? head : head.substr(0, head.rfind('.')));
}

Result<const ColmapModel*> found(const ColmapModel* model, const std::string& name, const std::string& where) {
  if (model != kModels.end()) return model;
  return Error{ErrorId::CameraModel, where + "camera model \"" + name +
                                         "\" is not supported; undistort to PINHOLE, or use SIMPLE_RADIAL, " +
                                         "OPENCV, FULL_OPENCV or OPENCV_FISHEYE"};
}

}  // namespace

Result<const ColmapModel*> colmapModel(std::string_view name, const std::string& where) {
  const auto it = std::find_if(kModels.begin(), kModels.end(), [&](const ColmapModel& m) { return m.name == name; });
  return found(it, std::string(name), where);
}

Result<const ColmapModel*> colmapModel(int number, const std::string& where) {
  const auto it =
      std::find_if(kModels.begin(), kModels.end(), [&](const ColmapModel& m) { return m.number == number; });
  return found(it, "number " + std::to_string(number), where);
}

Error colmapPoseError(const std::string& where, const std::string& what) {
  return {ErrorId::CameraPose, where + what + "; export the calibration again"};
}

Result<ColmapIntrinsics> makeIntrinsics(const ColmapModel& model, int width, int height, const double* parameters,
                                        const std::string& where) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    return colmapPoseError(where, "width and height must be 1 to 32768 pixels");
  ColmapIntrinsics intrinsics = model.make(parameters);
  intrinsics.width = width;
  intrinsics.height = height;
  if (saneIntrinsics(intrinsics)) return intrinsics;
  return colmapPoseError(where, "focal lengths must be positive and all numbers finite");
}

Result<CaptureCamera> makeColmapCamera(const ColmapIntrinsics& k, const std::array<double, 7>& pose,
                                       std::string_view image_name, const std::string& where) {
  if (!std::all_of(pose.begin(), pose.end(), [](double v) { return std::isfinite(v); }))
    return colmapPoseError(where, "the pose must be seven finite numbers (QW QX QY QZ TX TY TZ)");
  const glm::dquat rotation(pose[0], pose[1], pose[2], pose[3]);
  if (!(glm::length(rotation) > 1e-6) || !std::isfinite(glm::length(rotation)))
    return colmapPoseError(where, "the rotation quaternion has no length, so the pose is singular");
  CaptureCamera camera;
  camera.pinhole = {cameraNameOf(image_name), k.width, k.height, k.fx, k.fy, k.cx, k.cy};
  camera.pinhole.cam_from_world = glm::dmat4(glm::mat3_cast(glm::normalize(rotation)));
  camera.pinhole.cam_from_world[3] = glm::dvec4(pose[4], pose[5], pose[6], 1);
  camera.distortion = k.distortion;
  const std::string& name = camera.pinhole.name;
  if (name.empty()) return colmapPoseError(where, "the image has no name");
  if (name == "." || name == "..")
    return colmapPoseError(where, "an image called " + name + " cannot name a camera's files");
  return camera;
}

}  // namespace fourdvt::capture
