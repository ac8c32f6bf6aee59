// SPDX-License-Identifier: Apache-2.0
// FFmpeg's libraries behind base/video.h, and a decoder fed sample by sample like the browser's VideoDecoder.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/video.h"

namespace fourdvt::platform {

constexpr int64_t kMaxVideoPixels = int64_t{16384} * 8192;  // of a picture of a capture's video
constexpr int64_t kMaxSamplePixels = int64_t{4096} * 4096;  // of a character's (package/FORMAT.md)

// Opens no other file or address, whatever the file names: playlists are refused.
// Errors: FileMissing, FileUnreadable (no video stream, unknown codec, pictures too large).
Result<std::unique_ptr<VideoSource>> openVideoFile(const std::string& path, int channels);
// The same. A skip far ahead needs the pictures' time stamps, for which a file without an index, as of Matroska, is
// read to its end; they are kept in `index_folder`, if there is such a folder, for whoever opens the same file again.
Result<std::unique_ptr<VideoSource>> openIndexedVideo(const std::string& path, int channels,
                                                      const std::string& index_folder);
// Puts a video's time stamps into the folder, if they are not there and if seeking needs them. Errors: those of
// openVideoFile.
Status indexVideo(const std::string& path, const std::string& index_folder);

// WebCodecs' shape: configure, decode(bytes, timestamp, key), flush; pictures come back through the callback in
// presentation order with their timestamps. Pictures that are not 8-bit 4:2:0 are an error.
class SampleDecoder {
 public:
  using OnPicture = std::function<void(const I420View& picture, int64_t timestamp_us)>;
  // codec: RFC 6381 string ("avc1…", "av01…", "vp09…"). Errors: DecoderUnsupported.
  static Result<std::unique_ptr<SampleDecoder>> create(const std::string& codec, std::span<const uint8_t> description,
                                                       OnPicture on_picture);
  virtual ~SampleDecoder() = default;
  virtual Status decode(std::span<const uint8_t> bytes, int64_t timestamp_us, bool key) = 0;  // VideoInvalid
  virtual Status flush() = 0;  // outputs everything; a key sample must follow
  virtual void reset() = 0;
};

}  // namespace fourdvt::platform
