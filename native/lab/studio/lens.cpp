// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/lens.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::studio {
namespace {

constexpr int kMaxNewtonSteps = 50;
constexpr double kRadiusAccuracy = 1e-12;

glm::dvec2 throughPinhole(const PinholeCamera& c, const glm::dvec2& pixel) {
  return {(pixel.x - c.cx) / c.fx, (pixel.y - c.cy) / c.fy};
}

}  // namespace

// Distorted radius of a pinhole radius; both on the plane at distance 1.
double Lens::imagedAt(double r) const {
  const double r2 = r * r;
  return r * (1 + r2 * (k_[0] + r2 * (k_[1] + r2 * k_[2])));
}

double Lens::slopeAt(double r) const {
  const double r2 = r * r;
  return 1 + r2 * (3 * k_[0] + r2 * (5 * k_[1] + r2 * 7 * k_[2]));
}

// Inverts imagedAt() by Newton's method.
double Lens::radiusOf(double imaged) const {
  double r = imaged;
  for (int i = 0; i < kMaxNewtonSteps && std::abs(imagedAt(r) - imaged) > kRadiusAccuracy; ++i)
    r = std::max(0.0, r - (imagedAt(r) - imaged) / slopeAt(r));
  return r;
}

Result<Lens> Lens::create(const std::array<double, 3>& coefficients, const PinholeCamera& camera) {
  Lens lens(coefficients);
  const double corner = glm::length(throughPinhole(camera, {0, 0}));
  const Error wrong{
      ErrorId::InvalidArgument,
      "a lens of these coefficients folds the picture or needs far more than it shows; choose smaller ones"};
  double r = 0;
  for (; lens.imagedAt(r) < corner; r += 1e-3 * corner)
    if (lens.slopeAt(r) <= 0.1 || r > kMaxEnlarged * corner) return wrong;
  if (!lens.any()) return lens;
  const auto beyond = [&](const glm::dvec2& filmed) {
    const glm::dvec2 p = lens.pinholePixel(camera, filmed), size(camera.width, camera.height);
    lens.margin_ = glm::max(lens.margin_, glm::ivec2(glm::ceil(glm::max(-p, p - size))) + 2);
  };
  for (int x = 0; x <= camera.width; ++x)
    for (const int y : {0, camera.height}) beyond({x, y});
  for (int y = 0; y <= camera.height; ++y)
    for (const int x : {0, camera.width}) beyond({x, y});
  return lens;
}

glm::dvec2 Lens::pinholePixel(const PinholeCamera& camera, const glm::dvec2& filmed_pixel) const {
  if (!any()) return filmed_pixel;
  const glm::dvec2 imaged = throughPinhole(camera, filmed_pixel);
  const double radius = glm::length(imaged);
  if (radius == 0) return filmed_pixel;
  const glm::dvec2 ray = imaged * (radiusOf(radius) / radius);
  return {camera.fx * ray.x + camera.cx, camera.fy * ray.y + camera.cy};
}

PinholeCamera Lens::drawn(const PinholeCamera& camera) const {
  if (!any()) return camera;
  PinholeCamera out = camera;
  out.width = kFiner * (camera.width + 2 * margin_.x);
  out.height = kFiner * (camera.height + 2 * margin_.y);
  out.fx *= kFiner;
  out.fy *= kFiner;
  out.cx = kFiner * (camera.cx + margin_.x);
  out.cy = kFiner * (camera.cy + margin_.y);
  return out;
}

Image Lens::filmed(const PinholeCamera& camera, const Image& drawn_picture) const {
  if (!any()) return drawn_picture;
  cv::Mat map(kFiner * camera.height, kFiner * camera.width, CV_32FC2);
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const glm::dvec2 p = pinholePixel(camera, {(x + 0.5) / kFiner, (y + 0.5) / kFiner});
      const glm::dvec2 from = double(kFiner) * (p + glm::dvec2(margin_)) - 0.5;  // OpenCV's first pixel is at 0
      map.at<cv::Vec2f>(y, x) = cv::Vec2f(float(from.x), float(from.y));
    }
  const int type = CV_8UC(drawn_picture.channels);
  const cv::Mat from(drawn_picture.height, drawn_picture.width, type,
                     const_cast<uint8_t*>(drawn_picture.pixels.data()));
  cv::Mat samples;
  cv::remap(from, samples, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  Image out(camera.width, camera.height, drawn_picture.channels);
  cv::Mat to(out.height, out.width, type, out.pixels.data());
  cv::resize(samples, to, to.size(), 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace fourdvt::studio
