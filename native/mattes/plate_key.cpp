// SPDX-License-Identifier: Apache-2.0
#include "mattes/plate_key.h"

#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/pictures.h"
#include "capture/undistort.h"
#include "mattes/background_key.h"
#include "mattes/reduced.h"

namespace fourdvt::mattes {
namespace {

// Maps the difference of two RGB colours to their difference in the CbCr plane, which is linear.
float chromaDistance(const uint8_t* a, const uint8_t* b) {
  const float r = static_cast<float>(a[0]) - b[0], g = static_cast<float>(a[1]) - b[1],
              bl = static_cast<float>(a[2]) - b[2];
  const float luma = 0.2126f * r + 0.7152f * g + 0.0722f * bl;
  const float cb = (bl - luma) / 1.8556f, cr = (r - luma) / 1.5748f;
  return std::sqrt(cb * cb + cr * cr);
}

}  // namespace

Image chromaKey(const Image& picture, const Image& plate, const ChromaKeyOptions& options) {
  assert(picture.channels == 3 && plate.channels == 3);
  assert(picture.width == plate.width && picture.height == plate.height);
  Image alpha(picture.width, picture.height, 1);
  const float scale = 255.0f / (options.foreground_above - options.background_below);
  for (size_t i = 0; i < alpha.pixels.size(); ++i) {
    const float distance = chromaDistance(&picture.pixels[i * 3], &plate.pixels[i * 3]);
    const float value = (distance - options.background_below) * scale;
    alpha.pixels[i] = static_cast<uint8_t>(std::lround(std::fmin(255.0f, std::fmax(0.0f, value))));
  }
  Image clean(picture.width, picture.height, 1);
  cv::Mat in = matrixOf(alpha), out = matrixOf(clean);
  const cv::Mat element = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::morphologyEx(in, out, cv::MORPH_OPEN, element);
  cv::morphologyEx(out, out, cv::MORPH_CLOSE, element);
  return clean;
}

Result<PlateKey> PlateKey::open(const capture::Capture& capture, const capture::CaptureCamera& camera) {
  const std::string& name = camera.pinhole.name;
  PlateKey key;
  FOURDVT_ASSIGN(
      auto read,
      capture::readPlates(capture, camera,
                          "no readable plate of the empty studio, and camera \"" + name + "\" has no mattes; add " +
                              capture::matteStem(name) +
                              ".mkv or the plate, or make mattes without plates: fourdvt mattes " + capture.folder));
  std::vector<Image>& plates = read.pictures;
  key.path_ = read.path;
  key.natural_ = capture.background_kind == capture::BackgroundKind::Natural ||
                 (capture.background_kind == capture::BackgroundKind::FromPlate && !isChromaPlate(plates[0]));
  if (key.natural_)
    key.model_ = makeBackgroundModel(plates);
  else
    key.plate_ = plates.size() == 1 ? std::move(plates[0]) : meanPicture(makeBackgroundModel(plates));
  return key;
}

Image PlateKey::matte(const Image& picture, float* residual_levels) const {
  if (residual_levels) *residual_levels = 0;
  if (!natural_) return chromaKey(picture, plate_);
  const PlateFit fit = fitPlate(model_, picture);
  if (residual_levels) *residual_levels = fit.residual_levels;
  return backgroundKey(picture, fit.background);
}

Error plateDoesNotFit(const std::string& plate, const std::string& pictures, const std::string& camera) {
  return {ErrorId::FileUnreadable,
          plate + ": the plate does not fit the pictures of " + pictures +
              ", which differ from it nearly everywhere; take it again with the camera, the light and the " +
              "exposure of the recording, or add " + capture::matteStem(camera) + ".mkv"};
}

Result<Image> readRoomPlate(const capture::Capture& capture, const capture::CaptureCamera& camera) {
  FOURDVT_ASSIGN(auto plates,
                 capture::readPlates(capture, camera,
                                     "no readable plate of the empty room, but " + capture.folder +
                                         "/capture.json gives a \"room\", which is textured from the plates of "
                                         "all cameras; add the plate, or take \"room\" out"));
  const capture::Undistorter undistorter(camera);
  const Image colour = undistorter.apply(meanPicture(makeBackgroundModel(plates.pictures)));
  const Image reach = undistorter.apply(Image(colour.width, colour.height, 1, 255));
  Image out(colour.width, colour.height, 4);
  for (size_t i = 0; i < reach.pixels.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) out.pixels[4 * i + c] = colour.pixels[3 * i + c];
    out.pixels[4 * i + 3] = reach.pixels[i];
  }
  return out;
}

}  // namespace fourdvt::mattes
