// SPDX-License-Identifier: Apache-2.0
// Pictures from whatever FFmpeg opens: files, cameras at this machine, network addresses. Pictures are decoded without
// being converted, so that those that come too late cost little. Does NOT keep time.
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
  std::string format;                          // FFmpeg's input format, e.g. "v4l2"; empty: told from the url
  std::map<std::string, std::string> options;  // FFmpeg's, of the input
};

class VideoInput {
 public:
  // `stop`, which outlives the input, ends waiting for a device or the network. A file opens no other file or address.
  // Errors: FileMissing, FileUnreadable (not opened, no video, unknown codec), Unsupported (no such input format).
  static Result<std::unique_ptr<VideoInput>> open(const InputPlace& place, const std::atomic<bool>* stop = nullptr);
  virtual ~VideoInput() = default;
  virtual bool isFile() const = 0;  // with a known number of pictures
  // Number of pictures in a file, found by reading it once; else 0.
  virtual uint32_t pictures() const = 0;
  // Decodes a file's picture by its number; near numbers in ascending order are quick. Errors: FileUnreadable.
  virtual Status decode(uint32_t number) = 0;
  // Decodes the next picture of a device or address. Errors: FileUnreadable (it ended, or failed).
  virtual Status decodeNext() = 0;
  // Since 1970, where a device stamps its pictures with that; else 0. Of the decoded picture.
  virtual int64_t wallClock_us() const = 0;
  // Converts the decoded picture: RGB, into `out`, whose memory is used again; its sides divided by `reduce` and
  // rounded down. Errors: FileUnreadable.
  virtual Status convert(Image& out, int reduce = 1) = 0;
};

}  // namespace fourdvt::platform
