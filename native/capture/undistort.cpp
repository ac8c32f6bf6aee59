// SPDX-License-Identifier: Apache-2.0
#include "capture/undistort.h"

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::capture {

namespace {

glm::dvec2 throughFisheye(const Distortion& d, const glm::dvec2& point) {
  const double r = glm::length(point), angle = std::atan(r), a2 = angle * angle;
  if (r < 1e-12) return point;
  const double radial = 1 + a2 * (d.k1 + a2 * (d.k2 + a2 * (d.k3 + a2 * d.k4)));
  const double u = point.x * angle / r, v = point.y * angle / r;
  return {u * radial + 2 * d.p1 * u * v + d.p2 * (a2 + 2 * u * u) + d.sx1 * a2,
          v * radial + d.p1 * (a2 + 2 * v * v) + 2 * d.p2 * u * v + d.sy1 * a2};
}

glm::dvec2 throughFov(double fov, const glm::dvec2& point) {
  const double r = glm::length(point);
  if (r < 1e-12) return point * (2 * std::tan(fov / 2) / fov);
  return point * (std::atan(2 * r * std::tan(fov / 2)) / (r * fov));
}

glm::dvec2 throughLens(const Distortion& d, const glm::dvec2& point) {
  if (d.fisheye) return throughFisheye(d, point);
  if (d.fov != 0) return throughFov(d.fov, point);
  const double x = point.x, y = point.y, r2 = x * x + y * y;
  const double radial = (1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3))) / (1 + r2 * (d.k4 + r2 * (d.k5 + r2 * d.k6)));
  return {x * radial + 2 * d.p1 * x * y + d.p2 * (r2 + 2 * x * x),
          y * radial + d.p1 * (r2 + 2 * y * y) + 2 * d.p2 * x * y};
}

// Remap of the lens, with skew and every fisheye model, which OpenCV's maps lack. Clamped to ±1e6 pixels.
cv::Mat lensMap(const CaptureCamera& camera) {
  cv::Mat map(camera.pinhole.height, camera.pinhole.width, CV_32FC2);
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.cols; ++i) {
      const glm::dvec2 filmed = glm::clamp(filmedPixel(camera, {i + 0.5, j + 0.5}), -1e6, 1e6);
      map.at<cv::Vec2f>(j, i) = cv::Vec2f(float(filmed.x - 0.5), float(filmed.y - 0.5));
    }
  }
  return map;
}

}  // namespace

glm::dvec2 filmedPixel(const CaptureCamera& camera, const glm::dvec2& pinhole_pixel) {
  const PinholeCamera& p = camera.pinhole;
  const glm::dvec2 ray((pinhole_pixel.x - p.cx) / p.fx, (pinhole_pixel.y - p.cy) / p.fy);
  const glm::dvec2 bent = throughLens(camera.distortion, ray);
  return {p.fx * bent.x + camera.distortion.skew * bent.y + p.cx, p.fy * bent.y + p.cy};
}

struct Undistorter::Maps {
  cv::Mat xy, fraction;  // OpenCV's fixed-point form
};

Undistorter::Undistorter(const CaptureCamera& camera) {
  if (!camera.distortion.any()) return;
  const PinholeCamera& p = camera.pinhole;
  const Distortion& d = camera.distortion;
  maps_ = std::make_unique<Maps>();
  if (d.fisheye || d.fov != 0 || d.skew != 0) {
    cv::convertMaps(lensMap(camera), cv::noArray(), maps_->xy, maps_->fraction, CV_16SC2);
    return;
  }
  // OpenCV's first pixel centre is at 0, COLMAP's at 0.5.
  const cv::Matx33d intrinsics(p.fx, 0, p.cx - 0.5, 0, p.fy, p.cy - 0.5, 0, 0, 1);
  const cv::Vec<double, 8> coefficients(d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6);
  cv::initUndistortRectifyMap(intrinsics, coefficients, cv::noArray(), intrinsics, {p.width, p.height}, CV_16SC2,
                              maps_->xy, maps_->fraction);
}

Undistorter::~Undistorter() = default;
Undistorter::Undistorter(Undistorter&&) noexcept = default;
Undistorter& Undistorter::operator=(Undistorter&&) noexcept = default;

Image Undistorter::apply(Image picture, LensFilter filter) const {
  if (!maps_) return picture;
  Image out(picture.width, picture.height, picture.channels);
  const int type = CV_8UC(picture.channels);
  const cv::Mat from(picture.height, picture.width, type, picture.pixels.data());
  cv::Mat to(out.height, out.width, type, out.pixels.data());
  const bool matte = picture.channels == 1;
  cv::remap(from, to, maps_->xy, maps_->fraction,
            matte || filter == LensFilter::Fast ? cv::INTER_LINEAR : cv::INTER_CUBIC,
            matte ? cv::BORDER_CONSTANT : cv::BORDER_REPLICATE);
  return out;
}

glm::dvec2 pinholePixel(const CaptureCamera& camera, const glm::dvec2& filmed_pixel) {
  if (!camera.distortion.any()) return filmed_pixel;
  constexpr double kStep = 0.01, kEnough = 1e-4;  // pixels
  glm::dvec2 at = filmed_pixel;
  for (int round = 0; round < 30; ++round) {
    const glm::dvec2 here = filmedPixel(camera, at), off = filmed_pixel - here;
    if (glm::length(off) < kEnough) return at;
    const glm::dmat2 slope((filmedPixel(camera, at + glm::dvec2(kStep, 0)) - here) / kStep,
                           (filmedPixel(camera, at + glm::dvec2(0, kStep)) - here) / kStep);
    if (!(glm::determinant(slope) > 1e-3)) break;  // the lens formula is not monotonic beyond this point
    at += glm::inverse(slope) * off;
  }
  return glm::dvec2(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace fourdvt::capture
