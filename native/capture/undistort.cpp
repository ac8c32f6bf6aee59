// SPDX-License-Identifier: Apache-2.0
#include "capture/undistort.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::capture {

struct Undistorter::Maps {
  cv::Mat xy, fraction;  // OpenCV's fixed-point form
};

Undistorter::Undistorter(const CaptureCamera& camera) {
  if (!camera.distortion.any()) return;
  const PinholeCamera& p = camera.pinhole;
  const Distortion& d = camera.distortion;
  // OpenCV puts the first pixel's centre at 0, COLMAP at 0.5.
  const cv::Matx33d intrinsics(p.fx, 0, p.cx - 0.5, 0, p.fy, p.cy - 0.5, 0, 0, 1);
  const cv::Vec4d coefficients(d.k1, d.k2, d.p1, d.p2);
  maps_ = std::make_unique<Maps>();
  cv::initUndistortRectifyMap(intrinsics, coefficients, cv::noArray(), intrinsics, {p.width, p.height}, CV_16SC2,
                              maps_->xy, maps_->fraction);
}

Undistorter::~Undistorter() = default;
Undistorter::Undistorter(Undistorter&&) noexcept = default;
Undistorter& Undistorter::operator=(Undistorter&&) noexcept = default;

Image Undistorter::apply(Image picture) const {
  if (!maps_) return picture;
  Image out(picture.width, picture.height, picture.channels);
  const int type = CV_8UC(picture.channels);
  const cv::Mat from(picture.height, picture.width, type, picture.pixels.data());
  cv::Mat to(out.height, out.width, type, out.pixels.data());
  const bool matte = picture.channels == 1;
  cv::remap(from, to, maps_->xy, maps_->fraction, matte ? cv::INTER_LINEAR : cv::INTER_CUBIC,
            matte ? cv::BORDER_CONSTANT : cv::BORDER_REPLICATE);
  return out;
}

}  // namespace fourdvt::capture
