// SPDX-License-Identifier: Apache-2.0
// Video files from pictures: H.264 (libx264, BT.709 limited range, 4:2:0) of RGB, as .mp4 (faststart) or .mkv, or
// lossless FFV1 .mkv of one channel. finish() renames NAME.part to the final name; a partial .mkv is playable if the
// program dies. Pictures are not scaled.
#pragma once

#include <memory>
#include <string>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::platform {

struct VideoFormat {
  int width = 0, height = 0;  // even
  int channels = 3;           // 3: H.264; 1: FFV1
  double fps = 25;
  int crf = 18;                   // H.264 only; smaller is better
  const char* preset = "medium";  // H.264 only; libx264's
  bool reproducible = false;      // the bytes depend on the pictures only; slower and larger
};

class VideoWriter {
 public:
  // Errors: WriteFailed, Unsupported (this FFmpeg has no such encoder).
  static Result<std::unique_ptr<VideoWriter>> create(const std::string& path, const VideoFormat& format);
  virtual ~VideoWriter() = default;
  // Appends a picture of `channels` channels, or of 4 instead of 3, composited over black. Errors: WriteFailed,
  // Internal (another size).
  virtual Status write(const Image& picture) = 0;
  virtual Status finish() = 0;  // the last call
};

}  // namespace fourdvt::platform
