// SPDX-License-Identifier: Apache-2.0
#include "capture/plate_key.h"

#include <cmath>
#include <filesystem>

#include "capture/background_key.h"
#include "capture/matte.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"

namespace fourdvt::capture {
namespace {

constexpr uint32_t kMaxPlates = 100;  // more do not make the mean better, and each costs memory while it is read
constexpr double kBorderShare = 0.85, kPictureShare = 0.5, kLeftOutShare = 0.001;

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

// One file, or the numbered ones; the one that is missed if there are none.
std::vector<std::string> platePaths(const std::string& stem) {
  if (exists(stem + ".png")) return {stem + ".png"};
  for (const char* extension : {".png", ".jpg"}) {
    std::vector<std::string> paths;
    while (paths.size() < kMaxPlates) {
      const std::string path = framePath(stem + "/%06d" + extension, static_cast<uint32_t>(paths.size()));
      if (!exists(path)) break;
      paths.push_back(path);
    }
    if (!paths.empty()) return paths;
  }
  return {stem + ".png"};
}

Image rounded(const BackgroundModel& model) {
  Image out(model.width, model.height, 3);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = static_cast<uint8_t>(std::lround(model.mean[i]));
  return out;
}

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
  std::vector<Image> plates;
  for (const std::string& path : platePaths(capture.background_folder + "/" + name)) {
    auto plate = readPicture(path, 3);
    if (!plate.ok()) {
      return Error{plate.error().id, path + ": no readable plate of the empty studio, and camera \"" + name +
                                         "\" has no mattes; add " + matteStem(name) + ".mkv or the plate"};
    }
    FOURDVT_TRY(checkSize(plate.value(), camera, path));
    plates.push_back(plate.take());
    if (key.path_.empty()) key.path_ = path;
  }
  key.natural_ = capture.background_kind == BackgroundKind::Natural ||
                 (capture.background_kind == BackgroundKind::FromPlate && !isChromaPlate(plates[0]));
  if (key.natural_)
    key.model_ = makeBackgroundModel(plates);
  else
    key.plate_ = plates.size() == 1 ? std::move(plates[0]) : rounded(makeBackgroundModel(plates));
  return key;
}

Image PlateKey::matte(const Image& picture) const {
  return natural_ ? backgroundKey(picture, model_) : chromaKey(picture, plate_);
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
