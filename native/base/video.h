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

// Sequential reader of one video. Holds a bounded number of pictures whatever the video's length.
class VideoSource {
 public:
  virtual ~VideoSource() = default;
  // Next picture in presentation order, or nullopt at the end. 3 channels (sRGB via the stream's matrix and range,
  // limited where unspecified, and then BT.601 up to 576 lines, else BT.709) or 1 channel (as opened).
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
  // Upper bound on the number of pictures in the whole file where the container tells it without decoding.
  virtual std::optional<uint64_t> frameCountHint() const { return std::nullopt; }
  // How pictures are to be shown; next() gives them as they are stored.
  virtual PictureMarks marks() const { return {}; }
  // Conversions that next() makes by other marks of the file, for reports; known once a picture has been read.
  virtual std::vector<std::string> conversions() const { return {}; }
  // Mean frame rate by the container's header; nothing if it has none.
  virtual std::optional<double> framesPerSecond() const { return std::nullopt; }
};

// Opens `path`; channels is 3 or 1.
using OpenVideo = std::function<Result<std::unique_ptr<VideoSource>>(const std::string& path, int channels)>;

}  // namespace fourdvt
