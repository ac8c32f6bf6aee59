// SPDX-License-Identifier: Apache-2.0
#include "capture/colmap_model.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace fourdvt::capture {
namespace {

constexpr int kMaxSide = 32768;   // pixels
constexpr double kMaxFov = 3.14;  // radians
constexpr double kNoFov = 1e-6;   // radians: below it the lens is a pinhole

ColmapIntrinsics oneFocal(const double* p, const Distortion& d) { return {0, 0, p[0], p[0], p[1], p[2], d}; }
ColmapIntrinsics twoFocals(const double* p, const Distortion& d) { return {0, 0, p[0], p[1], p[2], p[3], d}; }

Distortion fisheye(double k1, double k2 = 0, double k3 = 0, double k4 = 0) {
  return {.k1 = k1, .k2 = k2, .k3 = k3, .k4 = k4, .fisheye = true};
}

constexpr std::array<ColmapModel, 11> kModels{{
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
    {7, "FOV", 5, [](const double* p) { return twoFocals(p, {.fov = std::abs(p[4]) < kNoFov ? 0 : p[4]}); }},
    {8, "SIMPLE_RADIAL_FISHEYE", 4, [](const double* p) { return oneFocal(p, fisheye(p[3])); }},
    {9, "RADIAL_FISHEYE", 5, [](const double* p) { return oneFocal(p, fisheye(p[3], p[4])); }},
    {10, "THIN_PRISM_FISHEYE", 12,
     [](const double* p) {
       Distortion d = fisheye(p[4], p[5], p[8], p[9]);
       d.p1 = p[6], d.p2 = p[7], d.sx1 = p[10], d.sy1 = p[11];
       return twoFocals(p, d);
     }},
}};

bool saneIntrinsics(const ColmapIntrinsics& i) {
  const Distortion& d = i.distortion;
  for (double v : {i.fx, i.fy, i.cx, i.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6, d.sx1, d.sy1, d.fov}) {
    if (!std::isfinite(v)) return false;
  }
  return i.fx > 0 && i.fy > 0 && d.fov >= 0 && d.fov < kMaxFov;
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
  return colmapPoseError(where, "focal lengths must be positive, a field of view below pi, and all numbers finite");
}

Error colmapCutOff(const std::string& file) {
  return {ErrorId::CameraPose, file + ": ends too early or is not COLMAP's binary model; export the calibration again"};
}

Status checkListedPath(std::string_view path, const std::string& where) {
  for (size_t at = path.find(".."); at != path.npos; at = path.find("..", at + 1)) {
    const auto ends = [&](size_t i) { return i >= path.size() || path[i] == '/' || path[i] == '\\'; };
    if ((at == 0 || ends(at - 1)) && ends(at + 2))
      return colmapPoseError(where, "an image called " + std::string(path) + " cannot name a camera's files");
  }
  return {};
}

Result<CaptureCamera> makeColmapCamera(const ColmapIntrinsics& k, const std::array<double, 7>& pose,
                                       const std::string& where) {
  if (!std::all_of(pose.begin(), pose.end(), [](double v) { return std::isfinite(v); }))
    return colmapPoseError(where, "the pose must be seven finite numbers (QW QX QY QZ TX TY TZ)");
  const glm::dquat rotation(pose[0], pose[1], pose[2], pose[3]);
  if (!(glm::length(rotation) > 1e-6) || !std::isfinite(glm::length(rotation)))
    return colmapPoseError(where, "the rotation quaternion has no length, so the pose is singular");
  CaptureCamera camera;
  camera.pinhole = {"", k.width, k.height, k.fx, k.fy, k.cx, k.cy};
  camera.pinhole.cam_from_world = glm::dmat4(glm::mat3_cast(glm::normalize(rotation)));
  camera.pinhole.cam_from_world[3] = glm::dvec4(pose[4], pose[5], pose[6], 1);
  camera.distortion = k.distortion;
  return camera;
}

}  // namespace fourdvt::capture
