// SPDX-License-Identifier: Apache-2.0
// Pictures from any FFmpeg input: files, local cameras, network addresses. Decoding is separate from conversion, so
// that late pictures are cheap to drop. Pacing stays with the caller.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::platform {

struct InputPlace {
  std::string url;                             // file, device or address
  std::string format;                          // FFmpeg's input format, e.g. "v4l2"; empty: derived from the url
  std::map<std::string, std::string> options;  // FFmpeg's input options
};

class VideoInput {
 public:
  // `stop` outlives the input and aborts waits for a device or the network. A file opens no other file or address.
  // Errors: FileMissing, FileUnreadable (not opened, no video, unknown codec), Unsupported (no such input format).
  static Result<std::unique_ptr<VideoInput>> open(const InputPlace& place, const std::atomic<bool>* stop = nullptr);
  virtual ~VideoInput() = default;
  virtual bool isFile() const = 0;  // true: the number of pictures is fixed
  // Number of pictures in a file, found by reading it once; 0 for devices and addresses.
  virtual uint32_t pictures() const = 0;
  // Decodes a file's picture by its number; fast for small ascending steps. Errors: FileUnreadable.
  virtual Status decode(uint32_t number) = 0;
  // Decodes the next picture of a device or address. Errors: FileUnreadable (it ended, or failed).
  virtual Status decodeNext() = 0;
  // Decoded picture's wall-clock time since 1970, if the device stamps it; else 0.
  virtual int64_t wallClock_us() const = 0;
  // Converts the decoded picture to RGB in `out`, whose memory is reused; sides divided by `reduce` and rounded down.
  // Errors: FileUnreadable.
  virtual Status convert(Image& out, int reduce = 1) = 0;
};

}  // namespace fourdvt::platform
