// SPDX-License-Identifier: Apache-2.0
// Pictures of a capture as filmed: of one camera over one sequence, from a video or from numbered files, and its plates
// of the empty studio.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/result.h"
#include "base/video.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// Location of a camera's colour pictures or mattes: a video file, or a folder with 000000.png (or .jpg) ….
struct PicturePlace {
  std::string path;       // the file, or the pattern of numbered files
  bool numbered = false;  // `path` is a pattern
};

// Finds <folder>/<stem>.mp4, .mkv, .webm, .mov, .avi or <folder>/<stem>/000000.png, .jpg; nullopt without one.
std::optional<PicturePlace> findPictures(const std::string& folder, const std::string& stem);

// Colour pictures of a camera in a sequence. Errors: CameraMissingVideo.
Result<PicturePlace> colourPlace(const CaptureSequence& sequence, const CaptureCamera& camera);

// Entries of a folder in the order of their names; empty if it cannot be listed.
std::vector<std::filesystem::path> sortedEntries(const std::filesystem::path& folder);

// Returns true for an existing file that is no folder; for an existing folder.
bool isFile(const std::string& path);
bool isFolder(const std::string& path);

// Name of a camera's matte: cam03 → mask03, other → maskother.
std::string matteStem(const std::string& camera_name);

// Reads a PNG or JPEG as stored, as 3 channels (RGB, converted to sRGB by the file's colour profile), 4 (RGBA; opaque
// where the file has no alpha), or 1: grey, or the alpha of a picture that is not opaque throughout. `marks` receives
// the file's display marks, unless null. Errors: FileMissing, FileUnreadable.
Result<Image> readPicture(const std::string& path, int channels, PictureMarks* marks = nullptr);

// Reads a picture as the camera is calibrated for it. Errors: those of readPicture; FrameSize.
Result<Image> readCalibrated(const std::string& path, int channels, const CaptureCamera& camera);

// Pictures that a camera must have for a sequence, including those before its first frame.
struct NeededPictures {
  NeededPictures(const CaptureSequence& sequence, const std::string& camera);
  Error tooFew(const std::string& path, const std::string& has) const;  // VideoTooShort

  std::vector<uint32_t> numbers;  // [frame] picture number
  uint32_t count = 0;
  bool as_declared = true;  // determined by "frames" alone
};

class PictureStream {
 public:
  // Opens the pictures. `check_files`: checks that all numbered files of the sequence exist; for videos see
  // checkClips. Errors: VideoTooShort, and those of `open_video`.
  static Result<PictureStream> open(const PicturePlace& place, const CaptureSequence& sequence,
                                    const CaptureCamera& camera, int channels, const OpenVideo& open_video,
                                    bool check_files = true);
  // Reads frames in ascending order, as the camera is calibrated for them; a video skips frames in between
  // (VideoSource::skip), and is reopened where a loop wraps around. Errors: VideoTooShort, FileUnreadable, FrameSize.
  Result<Image> read(uint32_t frame);
  const std::string& path() const { return place_.path; }
  std::string pathOf(uint32_t frame) const;  // file of this frame's picture

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

// Error FrameSize, naming `path`, unless the image has the camera's calibrated size.
Status checkSize(const Image& image, const CaptureCamera& camera, const std::string& path);

// Checks a sequence's videos by their containers' listings, without decoding, before long work. Errors: VideoTooShort
// if a video has fewer pictures than the sequence needs (by its listing, not its header), or lacks one that other
// cameras have, so that later pictures would show a later instant; those of `open_video`.
Status checkClips(const Capture& capture, const CaptureSequence& sequence, const OpenVideo& open_video,
                  MatteNeed mattes);

// Plates of a camera: pictures of the empty studio in the capture's background folder.
struct Plates {
  std::string path;             // path of the first plate
  std::vector<Image> pictures;  // RGB, as distorted as the videos
};

// Reads background/CAMERA.png, or else background/CAMERA/000000.png (or .jpg) and its successors up to a gap.
// `otherwise` ends the message if a plate cannot be read: the need for it, and the remedy. Errors: FileMissing,
// FileUnreadable, FrameSize.
Result<Plates> readPlates(const Capture& capture, const CaptureCamera& camera, const std::string& otherwise);

}  // namespace fourdvt::capture
