// SPDX-License-Identifier: Apache-2.0
#include "capture/plate_key.h"

#include "capture/background_key.h"
#include "capture/matte.h"
#include "capture/pictures.h"
#include "capture/plate_fit.h"
#include "capture/plates.h"

namespace fourdvt::capture {
namespace {

constexpr double kBorderShare = 0.85, kPictureShare = 0.5, kLeftOutShare = 0.001;

struct Kept {
  double border = 0, picture = 0;  // shares of the pixels
};

Kept keptBy(const Image& matte) {
  size_t border = 0, all = 0;
  for (int y = 0; y < matte.height; ++y)
    for (int x = 0; x < matte.width; ++x) {
      const bool kept = *matte.at(x, y) >= 128;
      all += kept;
      border += kept && (x == 0 || y == 0 || x == matte.width - 1 || y == matte.height - 1);
    }
  const double round = 2.0 * (matte.width + matte.height) - 4;
  return {double(border) / round, double(all) / double(matte.pixels.size())};
}

}  // namespace

Result<PlateKey> PlateKey::open(const Capture& capture, const CaptureCamera& camera) {
  const std::string& name = camera.pinhole.name;
  PlateKey key;
  FOURDVT_ASSIGN(auto read,
                 readPlates(capture, camera,
                            "no readable plate of the empty studio, and camera \"" + name + "\" has no mattes; add " +
                                matteStem(name) + ".mkv or the plate, or make mattes without plates: fourdvt mattes " +
                                capture.folder));
  std::vector<Image>& plates = read.pictures;
  key.path_ = read.path;
  key.natural_ = capture.background_kind == BackgroundKind::Natural ||
                 (capture.background_kind == BackgroundKind::FromPlate && !isChromaPlate(plates[0]));
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
              "exposure of the recording, or add " + matteStem(camera) + ".mkv"};
}

Error mattesAreSwapped(const std::string& path) {
  return {ErrorId::FileUnreadable,
          path + ": the matte keeps the picture's border and leaves out what is within, as if object and background " +
              "were swapped; invert the mattes: white is the object"};
}

bool keepsTheBorder(const Image& matte) {
  const Kept kept = keptBy(matte);
  return kept.border >= kBorderShare && kept.picture > kPictureShare;
}

bool looksInverted(const Image& matte) {
  const Kept kept = keptBy(matte);
  return kept.border >= kBorderShare && kept.picture > kPictureShare && kept.picture <= 1 - kLeftOutShare;
}

}  // namespace fourdvt::capture
