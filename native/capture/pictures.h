// SPDX-License-Identifier: Apache-2.0
// Pictures of one camera of one sequence, whether video or numbered files. Does NOT key or undistort.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/image.h"
#include "base/video.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// Where a camera's colour pictures or mattes are: a video file, or a folder with 000000.png (or .jpg) ….
struct PicturePlace {
  std::string path;       // file, or pattern of the numbered files
  bool numbered = false;  // pattern
};

// <folder>/<stem>.mp4/.mkv/.webm/.mov or <folder>/<stem>/000000.png/.jpg; nullopt if there is none of them.
std::optional<PicturePlace> findPictures(const std::string& folder, const std::string& stem);

// Name of a camera's matte: cam03 → mask03, other → maskother.
std::string matteStem(const std::string& camera_name);

// PNG or JPEG as 3 (RGB) or 1 channel. Errors: FileMissing, FileUnreadable.
Result<Image> readPicture(const std::string& path, int channels);

class PictureStream {
 public:
  // Checks what is cheap to know: the files are there and the container does not state too few frames.
  // Errors: VideoTooShort, and those of `open_video`.
  static Result<PictureStream> open(const PicturePlace& place, const CaptureSequence& sequence, int channels,
                                    const OpenVideo& open_video);
  // Frames in rising order; a video decodes and drops those between. Errors: VideoTooShort, FileUnreadable.
  Result<Image> read(uint32_t frame);
  const std::string& path() const { return place_.path; }

 private:
  Error tooShort(const std::string& has) const;
  Status checkFiles() const;

  PicturePlace place_;
  uint32_t frame_count_ = 0, next_ = 0;
  int channels_ = 3;
  std::unique_ptr<VideoSource> video_;
};

// Size as calibrated, else FrameSize naming `path`.
Status checkSize(const Image& image, const CaptureCamera& camera, const std::string& path);

}  // namespace fourdvt::capture
