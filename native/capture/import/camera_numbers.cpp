// SPDX-License-Identifier: Apache-2.0
#include "capture/import/camera_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace fourdvt::capture {
namespace {

constexpr double kMaxRotationError = 0.01;  // error of the elements of R Rᵀ; files round to three digits and more
constexpr int kMaxImportedSide = 32768;     // pixels

}  // namespace

Error badCalibration(const std::string& where, const std::string& what) {
  return {ErrorId::CameraPose, where + ": " + what + "; export the calibration again"};
}

glm::dmat3 rotationOf(const glm::dvec3& vector) {
  const double angle = glm::length(vector);
  if (angle == 0) return glm::dmat3(1);
  return glm::mat3_cast(glm::angleAxis(angle, vector / angle));
}

glm::dmat3 rowByRow(std::span<const double> nine) {
  glm::dmat3 out;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out[column][row] = nine[3 * row + column];
  return out;
}

glm::dmat3 rotationOfNumbers(std::span<const double> n) {
  return n.size() == 9 ? rowByRow(n) : rotationOf({n[0], n[1], n[2]});
}

Result<Distortion> distortionOf(std::span<const double> values, bool fisheye, const std::string& where) {
  const size_t known = fisheye ? 4 : 8;
  for (size_t i = known; i < values.size(); ++i) {
    if (values[i] == 0) continue;
    return Error{ErrorId::CameraModel, where + ": distortion has more than " + std::to_string(known) +
                                           " coefficients, and further ones (thin prism, tilt) are not read; "
                                           "calibrate without them"};
  }
  std::array<double, 8> c{};
  std::copy_n(values.begin(), std::min(known, values.size()), c.begin());
  if (fisheye) return Distortion{.k1 = c[0], .k2 = c[1], .k3 = c[2], .k4 = c[3], .fisheye = true};
  return Distortion{c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]};
}

Status setCameraMatrix(std::span<const double> k, double first_pixel, CaptureCamera& camera, const std::string& where) {
  if (k.size() != 9) return badCalibration(where, "the camera matrix must have nine numbers");
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || !(k[8] > 0))
    return badCalibration(where, "the camera matrix must be fx s cx, 0 fy cy, 0 0 1");
  PinholeCamera& p = camera.pinhole;
  p.fx = k[0] / k[8];
  p.fy = k[4] / k[8];
  p.cx = k[2] / k[8] + first_pixel;
  p.cy = k[5] / k[8] + first_pixel;
  camera.distortion.skew = k[1] / k[8];
  return {};
}

Status setPose(const glm::dmat3& rotation, const glm::dvec3& translation, CaptureCamera& camera,
               const std::string& where) {
  const glm::dmat3 product = rotation * glm::transpose(rotation);
  double error = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) error = std::max(error, std::abs(product[i][j] - (i == j ? 1 : 0)));
  const double determinant = glm::determinant(rotation);
  if (!(error <= kMaxRotationError) || !std::isfinite(determinant) || !(determinant > 0))
    return badCalibration(where, "the rotation is none (not orthogonal, mirrored or not finite)");
  glm::dmat4& pose = camera.pinhole.cam_from_world;
  pose = glm::dmat4(glm::mat3_cast(glm::normalize(glm::quat_cast(rotation))));
  pose[3] = glm::dvec4(translation, 1);
  return {};
}

Status checkCameraNumbers(const CaptureCamera& camera, const std::string& where) {
  const PinholeCamera& p = camera.pinhole;
  const Distortion& d = camera.distortion;
  const glm::dvec4 t = p.cam_from_world[3];
  for (double v : {p.fx, p.fy, p.cx, p.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6, d.skew, d.sx1, d.sy1, d.fov,
                   t.x, t.y, t.z})
    if (!std::isfinite(v)) return badCalibration(where, "all numbers must be finite");
  if (!(p.fx > 0) || !(p.fy > 0)) return badCalibration(where, "focal lengths must be positive");
  if (p.width < 0 || p.height < 0 || p.width > kMaxImportedSide || p.height > kMaxImportedSide)
    return badCalibration(where, "width and height must be 1 to 32768 pixels");
  return {};
}

}  // namespace fourdvt::capture
