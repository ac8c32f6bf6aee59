// SPDX-License-Identifier: Apache-2.0
// Writes the pictures of one camera over a sequence: as an H.264 .mp4 (RGB, BT.709 limited range, 4:2:0,
// near-lossless), a lossless FFV1 .mkv (one channel), or a folder of PNG files. Deterministic.
#pragma once

#include <memory>
#include <string>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::studio {

struct PictureFormat {
  int width = 0, height = 0;
  int channels = 3;  // 3: RGB, 1: a matte
  double fps = 0;
  bool images = false;  // PNG files instead of a video
};

class PictureFile {
 public:
  // Writes `stem`.mp4 for 3 channels and `stem`.mkv for 1, or `stem`/%06d.png with `images`. Errors: WriteFailed,
  // Unsupported (this FFmpeg lacks the encoder).
  static Result<std::unique_ptr<PictureFile>> create(const std::string& stem, const PictureFormat& format);
  virtual ~PictureFile() = default;
  virtual Status write(const Image& picture) = 0;
  virtual Status finish() = 0;  // the last call
};

}  // namespace fourdvt::studio
