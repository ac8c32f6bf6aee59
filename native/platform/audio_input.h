// SPDX-License-Identifier: Apache-2.0
// Reads the sound of a file, resampled, from its beginning to its end. Does NOT seek and does NOT mix files.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/result.h"

namespace fourdvt::platform {

class AudioReader {
 public:
  // A sound file, or a video with sound, of which the first sample that is read sounds when the first picture is shown.
  // More than two channels are mixed down to two. Errors: FileMissing, FileUnreadable (no sound in
  // it, or damaged).
  static Result<std::unique_ptr<AudioReader>> open(const std::string& path, int sample_rate);
  virtual ~AudioReader() = default;
  virtual int channels() const = 0;  // 1 or 2
  // Fills `out`, channels() interleaved values a sample, ±1 is full scale. Returns the number of samples: fewer than
  // fit only at the end of the file. Errors: FileUnreadable.
  virtual Result<size_t> read(std::span<float> out) = 0;
};

}  // namespace fourdvt::platform
