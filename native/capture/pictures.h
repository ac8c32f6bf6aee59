// SPDX-License-Identifier: Apache-2.0
// The pictures of one camera over one sequence, from a video or from numbered files. Does NOT key or undistort.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/picture_marks.h"
#include "base/video.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// Place of a camera's colour pictures or mattes: a video file, or a folder with 000000.png (or .jpg) ….
struct PicturePlace {
  std::string path;       // the file, or the pattern of the numbered files
  bool numbered = false;  // `path` is a pattern
};

// Looks for <folder>/<stem>.mp4, .mkv, .webm, .mov, .avi and <folder>/<stem>/000000.png, .jpg; nullopt if there is
// none.
std::optional<PicturePlace> findPictures(const std::string& folder, const std::string& stem);

// A camera's colour pictures in a sequence. Errors: CameraMissingVideo.
Result<PicturePlace> colourPlace(const CaptureSequence& sequence, const CaptureCamera& camera);

// Entries of a folder in the order of their names; none if it cannot be listed.
std::vector<std::filesystem::path> sortedEntries(const std::filesystem::path& folder);

// Returns true for an existing file that is no folder.
bool isFile(const std::string& path);

// Name of a camera's matte: cam03 → mask03, other → maskother.
std::string matteStem(const std::string& camera_name);

// Reads a PNG or JPEG as it lies in the file, as 3 channels (RGB; turned into sRGB by the file's colour profile), 4
// (RGBA; opaque where the file has no alpha), or 1: grey, or the alpha of a picture that is not opaque throughout.
// `marks`, if wanted: how it is to be shown. Errors: FileMissing, FileUnreadable.
Result<Image> readPicture(const std::string& path, int channels, PictureMarks* marks = nullptr);

// The same, as the camera is calibrated for it. Errors: those of readPicture; FrameSize.
Result<Image> readCalibrated(const std::string& path, int channels, const CaptureCamera& camera);

// Count of the pictures that a camera must have for a sequence, those before its first frame included.
struct NeededPictures {
  NeededPictures(const CaptureSequence& sequence, const std::string& camera);
  Error tooFew(const std::string& path, const std::string& has) const;  // VideoTooShort

  std::vector<uint32_t> numbers;  // [frame] of the picture
  uint32_t count = 0;
  bool as_declared = true;  // nothing but "frames" decides on it
};

class PictureStream {
 public:
  // Checks that numbered files are there; of videos see clip_checks.h.
  // `check_files`: numbered files are looked for, all of the sequence.
  // Errors: VideoTooShort, and those of `open_video`.
  static Result<PictureStream> open(const PicturePlace& place, const CaptureSequence& sequence,
                                    const CaptureCamera& camera, int channels, const OpenVideo& open_video,
                                    bool check_files = true);
  // Reads frames in ascending order, as the camera is calibrated for them; a video leaves out those in between
  // (VideoSource::skip), and is opened anew where a loop begins again. Errors: VideoTooShort, FileUnreadable,
  // FrameSize.
  Result<Image> read(uint32_t frame);
  const std::string& path() const { return place_.path; }
  std::string pathOf(uint32_t frame) const;  // the file that has this frame's picture

 private:
  PictureStream(const PicturePlace& place, const CaptureCamera& camera, NeededPictures needed)
      : place_(place), camera_(camera), needed_(std::move(needed)) {}
  Status checkFiles() const;

  PicturePlace place_;
  CaptureCamera camera_;
  NeededPictures needed_;
  uint32_t next_ = 0;  // number of the video's next picture
  OpenVideo open_video_;
  int channels_ = 3;
  std::unique_ptr<VideoSource> video_;
};

// Error FrameSize, naming `path`, if the image does not have the size that the camera is calibrated for.
Status checkSize(const Image& image, const CaptureCamera& camera, const std::string& path);

}  // namespace fourdvt::capture
