// SPDX-License-Identifier: Apache-2.0
// Validated cameras and lenses from the numbers of calibration files; common to all readers of this folder.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

constexpr double kFirstPixelAtZero = 0.5;  // offset from OpenCV's principal point

// Error CameraPose: "WHERE: WHAT; export the calibration again".
Error badCalibration(const std::string& where, const std::string& what);

// Rotation about `vector` by its length in radians (Rodrigues).
glm::dmat3 rotationOf(const glm::dvec3& vector);
// Matrix from nine numbers, row by row; rotation from nine numbers, row by row, or from a rotation vector.
glm::dmat3 rowByRow(std::span<const double> nine);
glm::dmat3 rotationOfNumbers(std::span<const double> three_or_nine);

// Distortion from `values` in OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6, or k1 k2 k3 k4 of a fisheye; missing ones are 0.
// Further ones (thin prism, tilt) must be 0. `where`: prefix of messages. Errors: CameraModel.
Result<Distortion> distortionOf(std::span<const double> values, bool fisheye, const std::string& where);

// Sets focal lengths, principal point (plus `first_pixel`) and skew from OpenCV's camera matrix, nine numbers row by
// row, with any scale. Errors: CameraPose.
Status setCameraMatrix(std::span<const double> nine, double first_pixel, CaptureCamera& camera,
                       const std::string& where);

// Sets a pose and makes its rotation exactly orthogonal. Refuses numbers that are not finite, focal lengths that are
// not positive, and matrices that are no rotations. Errors: CameraPose.
Status setPose(const glm::dmat3& rotation, const glm::dvec3& translation, CaptureCamera& camera,
               const std::string& where);
Status checkCameraNumbers(const CaptureCamera& camera, const std::string& where);

// Brown's model with a fourth radial coefficient, which OpenCV's lacks: 1 + k1 r² + k2 r⁴ + k3 r⁶ + k4 r⁸ with OpenCV's
// tangential p1 and p2.
struct Brown4 {
  double k1 = 0, k2 = 0, k3 = 0, k4 = 0, p1 = 0, p2 = 0;
};

struct LensFit {
  Distortion distortion;
  double residual = 0;  // maximum distance to the given lens within the radius, in focal lengths
};

// Fits OpenCV's rational model (lens_fit.cpp) to the lens up to `radius` (normalised coordinates); exact where k4 is 0.
LensFit fitBrown4(const Brown4& lens, double radius);

}  // namespace fourdvt::capture
