// SPDX-License-Identifier: Apache-2.0
// What portable code sees of a video file: pictures one after the other. platform/ implements it with FFmpeg.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/picture_marks.h"
#include "base/result.h"

namespace fourdvt {

// Contents of a video by its container's index or packets: no picture is decoded.
struct VideoListing {
  uint64_t pictures = 0;                  // that are stored whole and shown; the header may count others
  uint64_t announced = 0;                 // by the header's count, hidden ones included; 0: it has none
  bool cut_off = false;                   // the file ends before or inside of a picture
  std::vector<double> times_s;            // [picture] since the first one, ascending; empty: none to rely on
  double tick_s = 0;                      // unit of the times
  std::string timecode;                   // of the first picture, "10:00:00:12"; empty: none
  std::optional<double> timecode_s;       // the same since midnight
  std::string created;                    // "creation_time"; empty: none
  std::string track;                      // the video track that is read, for people
  std::vector<std::string> other_tracks;  // further video tracks, which are not read
};

// Sequential reader of one video. Holds a bounded number of pictures whatever the video's length.
class VideoSource {
 public:
  virtual ~VideoSource() = default;
  // Next picture in presentation order, or nullopt at the end. 3 channels (sRGB via the stream's matrix and range,
  // limited where unspecified, and then BT.601 up to 576 lines, else BT.709), 4 (the same and alpha, which is 255 where
  // the video has none) or 1 (as opened): grey, or the alpha of a picture that is not opaque throughout.
  virtual Result<std::optional<Image>> next() = 0;
  // Leaves out so many pictures, or all that are left. A file goes to the key picture before the wanted one where its
  // time stamps number the pictures; else those between are decoded.
  virtual Status skip(uint32_t pictures) {
    for (; pictures > 0; --pictures) {
      FOURDVT_ASSIGN(const auto picture, next());
      if (!picture) return {};
    }
    return {};
  }
  // Lists the whole file, which may be read for it, and goes back to the first picture. Errors: those of opening it;
  // Unsupported by default.
  virtual Result<VideoListing> list() { return Error{ErrorId::Unsupported, "this video cannot be listed"}; }
  // Marks of how pictures are to be shown; next() gives them as they are stored.
  virtual PictureMarks marks() const { return {}; }
  // Conversions that next() makes by other marks of the file, for reports; known once a picture has been read.
  virtual std::vector<std::string> conversions() const { return {}; }
  // Returns true if the video has an alpha channel by its headers, though it may be opaque throughout. What cannot be
  // decoded of it is an error where it is opened with 1 or 4 channels.
  virtual bool hasAlpha() const { return false; }
  // Mean frame rate by the container's header; nothing if it has none.
  virtual std::optional<double> framesPerSecond() const { return std::nullopt; }
};

// Opens `path`; channels is 1, 3 or 4.
using OpenVideo = std::function<Result<std::unique_ptr<VideoSource>>(const std::string& path, int channels)>;

}  // namespace fourdvt
