// SPDX-License-Identifier: Apache-2.0
#include "capture/plate_key.h"

#include "capture/background_key.h"
#include "capture/matte.h"
#include "capture/pictures.h"
#include "capture/plate_fit.h"
#include "capture/plates.h"

namespace fourdvt::capture {
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

}  // namespace fourdvt::capture
