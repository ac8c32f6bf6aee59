// SPDX-License-Identifier: Apache-2.0
// Reads the sound of one file, resampled, sequentially from start to end.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/result.h"

namespace fourdvt::platform {

class AudioReader {
 public:
  // Opens a sound file, or a video with sound; a video's first sample read is simultaneous with its first picture.
  // Mixes more than two channels down to two. Errors: FileMissing, FileUnreadable (no sound in it, or damaged).
  static Result<std::unique_ptr<AudioReader>> open(const std::string& path, int sample_rate);
  virtual ~AudioReader() = default;
  virtual int channels() const = 0;  // 1 or 2
  // Fills `out`, channels() interleaved values a sample, ±1 is full scale. Returns the number of samples; a short count
  // means the end of the file. Errors: FileUnreadable.
  virtual Result<size_t> read(std::span<float> out) = 0;
};

}  // namespace fourdvt::platform
