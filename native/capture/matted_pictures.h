// SPDX-License-Identifier: Apache-2.0
// Colour pictures of a camera over one sequence with their mattes: matte files (maskNN), or else the alpha of the
// colour pictures where it is not constant. Pictures stay distorted; keying is in native/mattes.
#pragma once

#include <optional>
#include <string>

#include "capture/pictures.h"

namespace fourdvt::capture {

// Source of a camera's own mattes.
enum class MatteOrigin { None, Files, ColourAlpha };

// Checks colour pictures that may have an alpha channel: the first, middle and last one. Errors: CameraMissingVideo,
// those of pictures.
Result<MatteOrigin> matteOrigin(const CaptureSequence& sequence, const CaptureCamera& camera,
                                const OpenVideo& open_video);

class MattedPictures {
 public:
  // `check_files`: see PictureStream::open. Errors: those of matteOrigin and PictureStream::open.
  static Result<MattedPictures> open(const CaptureSequence& sequence, const CaptureCamera& camera,
                                     const OpenVideo& open_video, MatteNeed need, bool check_files = true);
  // False: no mattes, or not required.
  bool hasMattes() const { return origin_ != MatteOrigin::None; }
  struct Pair {
    Image colour;  // RGB
    Image matte;   // one channel; empty without mattes
  };
  // Reads a frame; ascending order is fast. The first matte that is not empty is judged, and refused if none of three
  // others spread over the sequence is better. Errors: those of PictureStream::read; FrameSize; FileUnreadable (flawed
  // mattes, see matte_flaw.h).
  Result<Pair> read(uint32_t frame);
  const std::string& path() const { return colour_.path(); }

 private:
  MattedPictures(const CaptureSequence& sequence, const CaptureCamera& camera, const OpenVideo& open_video,
                 MatteOrigin origin, PictureStream colour)
      : sequence_(sequence), camera_(camera), open_video_(open_video), origin_(origin), colour_(std::move(colour)) {}
  std::string mattePath(uint32_t frame) const;
  Status judge(uint32_t frame, const Image& matte);

  CaptureSequence sequence_;
  CaptureCamera camera_;
  OpenVideo open_video_;
  MatteOrigin origin_;
  PictureStream colour_;
  std::optional<PictureStream> mattes_;  // matte files
  bool judged_ = false;
};

}  // namespace fourdvt::capture
