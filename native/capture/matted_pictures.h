// SPDX-License-Identifier: Apache-2.0
// A camera's colour pictures over one sequence with the mattes that came with them: files of their own (maskNN), or
// else the alpha of the colour pictures, where it is not constant. Does NOT key or undistort.
#pragma once

#include <optional>
#include <string>

#include "capture/pictures.h"

namespace fourdvt::capture {

// Place of a camera's own mattes.
enum class MatteOrigin { None, Files, ColourAlpha };

// Looks into colour pictures that may have an alpha channel: at the first one, the one in the middle and the last one.
// Errors: CameraMissingVideo, those of pictures.
Result<MatteOrigin> matteOrigin(const CaptureSequence& sequence, const CaptureCamera& camera,
                                const OpenVideo& open_video);

class MattedPictures {
 public:
  // `check_files`: see PictureStream::open. Errors: those of matteOrigin, of PictureStream::open.
  static Result<MattedPictures> open(const CaptureSequence& sequence, const CaptureCamera& camera,
                                     const OpenVideo& open_video, MatteNeed need, bool check_files = true);
  // False: the camera has none, or they were not required.
  bool hasMattes() const { return origin_ != MatteOrigin::None; }
  struct Pair {
    Image colour;  // RGB
    Image matte;   // one channel; empty without mattes
  };
  // Frames in ascending order are quick. The first matte that is not empty is judged: it is refused if no other one of
  // three that are spread over the sequence is better. Errors: those of PictureStream::read; FrameSize; FileUnreadable
  // (mattes that cannot be meant, see matte_flaw.h).
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
  std::optional<PictureStream> mattes_;  // files of their own
  bool judged_ = false;
};

}  // namespace fourdvt::capture
