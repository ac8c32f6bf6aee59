// SPDX-License-Identifier: Apache-2.0
#include "capture/matted_pictures.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "capture/matte_flaw.h"
#include "capture/mesh_sequence.h"

namespace fourdvt::capture {
namespace {

constexpr int kWithAlpha = 4;  // channels

// Frames of a sequence that are inspected where a single one is inconclusive.
std::array<uint32_t, 3> spreadFrames(const CaptureSequence& sequence) {
  const uint32_t last = std::max(1u, sequence.frame_count) - 1;
  return {0, last / 2, last};
}

Image alphaOf(const Image& rgba) {
  Image out(rgba.width, rgba.height, 1);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = rgba.pixels[4 * i + 3];
  return out;
}

Image colourOf(const Image& rgba) {
  Image out(rgba.width, rgba.height, 3);
  for (size_t i = 0; i < size_t(rgba.width) * rgba.height; ++i) std::copy_n(&rgba.pixels[4 * i], 3, &out.pixels[3 * i]);
  return out;
}

bool isConstant(const Image& matte) {
  return std::all_of(matte.pixels.begin(), matte.pixels.end(), [&](uint8_t v) { return v == matte.pixels[0]; });
}

// Returns false for JPEG, and PNG of grey or RGB; true where only decoding can decide.
bool pictureMayHaveAlpha(const std::string& path) {
  constexpr size_t kColourType = 25;  // offset in PNG's IHDR
  char head[kColourType + 1] = {};
  std::ifstream(path, std::ios::binary).read(head, sizeof head);
  const std::string_view begin(head, sizeof head);
  if (begin.starts_with("\xff\xd8")) return false;
  return !begin.starts_with("\x89PNG") || (head[kColourType] != 0 && head[kColourType] != 2);
}

// Tests the header of the first picture, or of the video. Errors: those of pictures.
Result<bool> mayHaveAlpha(const PicturePlace& place, const CaptureSequence& sequence, const CaptureCamera& camera,
                          const OpenVideo& open_video) {
  if (place.numbered) return pictureMayHaveAlpha(framePath(place.path, sequence.pictureOf(camera.pinhole.name, 0)));
  FOURDVT_ASSIGN(const auto video, open_video(place.path, 3));
  return video->hasAlpha();
}

Result<bool> alphaIsMatte(const PicturePlace& place, const CaptureSequence& sequence, const CaptureCamera& camera,
                          const OpenVideo& open_video) {
  FOURDVT_ASSIGN(const bool may, mayHaveAlpha(place, sequence, camera, open_video));
  if (!may) return false;
  FOURDVT_ASSIGN(auto stream, PictureStream::open(place, sequence, camera, kWithAlpha, open_video, false));
  for (const uint32_t frame : spreadFrames(sequence)) {
    FOURDVT_ASSIGN(const auto picture, stream.read(frame));
    if (!isConstant(alphaOf(picture))) return true;
  }
  return false;
}

}  // namespace

Result<MatteOrigin> matteOrigin(const CaptureSequence& sequence, const CaptureCamera& camera,
                                const OpenVideo& open_video) {
  if (findPictures(sequence.folder, matteStem(camera.pinhole.name))) return MatteOrigin::Files;
  FOURDVT_ASSIGN(const PicturePlace place, colourPlace(sequence, camera));
  FOURDVT_ASSIGN(const bool alpha, alphaIsMatte(place, sequence, camera, open_video));
  return alpha ? MatteOrigin::ColourAlpha : MatteOrigin::None;
}

Result<MattedPictures> MattedPictures::open(const CaptureSequence& sequence, const CaptureCamera& camera,
                                            const OpenVideo& open_video, MatteNeed need, bool check_files) {
  FOURDVT_ASSIGN(const PicturePlace place, colourPlace(sequence, camera));
  auto origin = MatteOrigin::None;
  if (need == MatteNeed::Required) {
    FOURDVT_ASSIGN(origin, matteOrigin(sequence, camera, open_video));
  }
  const int channels = origin == MatteOrigin::ColourAlpha ? kWithAlpha : 3;
  FOURDVT_ASSIGN(auto colour, PictureStream::open(place, sequence, camera, channels, open_video, check_files));
  MattedPictures out(sequence, camera, open_video, origin, std::move(colour));
  if (origin != MatteOrigin::Files) return out;
  const auto mattes = findPictures(sequence.folder, matteStem(camera.pinhole.name));
  FOURDVT_ASSIGN(out.mattes_, PictureStream::open(*mattes, sequence, camera, 1, open_video, check_files));
  return out;
}

std::string MattedPictures::mattePath(uint32_t frame) const {
  return mattes_ ? mattes_->pathOf(frame) : colour_.pathOf(frame) + " (alpha)";
}

Result<MattedPictures::Pair> MattedPictures::read(uint32_t frame) {
  Pair out;
  FOURDVT_ASSIGN(out.colour, colour_.read(frame));
  if (origin_ == MatteOrigin::ColourAlpha) {
    out.matte = alphaOf(out.colour);
    out.colour = colourOf(out.colour);
  } else if (mattes_) {
    FOURDVT_ASSIGN(out.matte, mattes_->read(frame));
  }
  if (hasMattes() && !judged_) FOURDVT_TRY(judge(frame, out.matte));
  return out;
}

// Tries other frames if the object fills the picture for a while.
Status MattedPictures::judge(uint32_t frame, const Image& matte) {
  if (isConstant(matte) && matte.pixels[0] == 0) return {};
  judged_ = true;
  MatteFlaw flaw = flawOf(matte);
  if (flaw == MatteFlaw::None) return {};
  FOURDVT_ASSIGN(auto other, open(sequence_, camera_, open_video_, MatteNeed::Required, false));
  other.judged_ = true;
  for (const uint32_t at : spreadFrames(sequence_)) {
    if (at == frame) continue;
    FOURDVT_ASSIGN(const auto pair, other.read(at));
    const MatteFlaw again = flawOf(pair.matte);
    if (again == MatteFlaw::None && !isConstant(pair.matte)) return {};
    if (again == MatteFlaw::Swapped) flaw = again;
  }
  return flawedMattes(flaw, mattePath(frame), camera_.pinhole.name);
}

}  // namespace fourdvt::capture
