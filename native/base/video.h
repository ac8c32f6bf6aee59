// SPDX-License-Identifier: Apache-2.0
// Portable interface of a video file: sequential pictures. platform/ implements it with FFmpeg.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt {

// Contents of a video, listed from its container's index or packets without decoding.
struct VideoListing {
  uint64_t pictures = 0;                  // stored completely and not hidden; the header's count may differ
  uint64_t announced = 0;                 // header's count, hidden ones included; 0: unavailable
  bool cut_off = false;                   // the file ends before or inside a picture
  std::vector<double> times_s;            // [picture] since the first one, ascending; empty: unreliable
  double tick_s = 0;                      // unit of the times
  std::string timecode;                   // first picture's, "10:00:00:12"; empty: none
  std::optional<double> timecode_s;       // the timecode, since midnight
  std::string created;                    // "creation_time"; empty: none
  std::string track;                      // label of the video track that is read
  std::vector<std::string> other_tracks;  // further video tracks, ignored
};

// Sequential reader of one video. Memory is bounded by a fixed number of pictures.
class VideoSource {
 public:
  virtual ~VideoSource() = default;
  // Decodes the next picture in presentation order; nullopt at the end. Channels, as opened: 3: sRGB via the stream's
  // matrix and range (unspecified: limited range, BT.601 up to 576 lines, else BT.709). 4: the same and alpha, 255 if
  // the video has none. 1: grey, or the alpha of a picture that is not opaque throughout.
  virtual Result<std::optional<Image>> next() = 0;
  // Skips up to this many pictures. Seeks to the keyframe before the target if the file's time stamps number its
  // pictures; otherwise decodes the pictures between.
  virtual Status skip(uint32_t pictures) {
    for (; pictures > 0; --pictures) {
      FOURDVT_ASSIGN(const auto picture, next());
      if (!picture) return {};
    }
    return {};
  }
  // Lists the whole file, reading it if necessary, and returns to the first picture. Errors: those of opening it;
  // Unsupported by default.
  virtual Result<VideoListing> list() { return Error{ErrorId::Unsupported, "this video cannot be listed"}; }
  // Display marks; next() returns pictures as stored, without applying them.
  virtual PictureMarks marks() const { return {}; }
  // Conversions that other marks of the file make next() apply, for reports; available once a picture has been read.
  virtual std::vector<std::string> conversions() const { return {}; }
  // Returns true if the headers announce an alpha channel, which may be opaque throughout. Opening such a video with 1
  // or 4 channels fails if this build cannot decode its alpha.
  virtual bool hasAlpha() const { return false; }
  // Mean frame rate by the container's header, if present.
  virtual std::optional<double> framesPerSecond() const { return std::nullopt; }
};

// Opens `path`; channels is 1, 3 or 4.
using OpenVideo = std::function<Result<std::unique_ptr<VideoSource>>(const std::string& path, int channels)>;

}  // namespace fourdvt
