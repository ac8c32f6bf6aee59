// SPDX-License-Identifier: Apache-2.0
// FFmpeg's implementation of base/video.h, and a decoder fed sample by sample like the browser's VideoDecoder.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/video.h"

namespace fourdvt::platform {

constexpr int64_t kMaxVideoPixels = int64_t{16384} * 8192;  // limit of a capture's video
constexpr int64_t kMaxSamplePixels = int64_t{4096} * 4096;  // limit of a character's (package/FORMAT.md)

// Opens this file only: rejects playlists, and references to other files or addresses. Errors: FileMissing,
// FileUnreadable (no video stream, unknown codec, pictures too large).
Result<std::unique_ptr<VideoSource>> openVideoFile(const std::string& path, int channels);
// Variant with cached time stamps. A skip far ahead needs the pictures' time stamps; a file without an index, such as
// Matroska, is read to its end for them. They are cached in `index_folder`, if that folder exists, for later opens of
// the same file.
Result<std::unique_ptr<VideoSource>> openIndexedVideo(const std::string& path, int channels,
                                                      const std::string& index_folder);
// Caches a video's time stamps in the folder, unless present or unnecessary for seeking. Errors: those of
// openVideoFile.
Status indexVideo(const std::string& path, const std::string& index_folder);

// WebCodecs' interface: configure, decode(bytes, timestamp, key), flush; the callback receives pictures in presentation
// order with their timestamps. Pictures that are not 8-bit 4:2:0 are an error.
class SampleDecoder {
 public:
  using OnPicture = std::function<void(const I420View& picture, int64_t timestamp_us)>;
  // codec: RFC 6381 string ("avc1…", "av01…", "vp09…"). Errors: DecoderUnsupported.
  static Result<std::unique_ptr<SampleDecoder>> create(const std::string& codec, std::span<const uint8_t> description,
                                                       OnPicture on_picture);
  virtual ~SampleDecoder() = default;
  virtual Status decode(std::span<const uint8_t> bytes, int64_t timestamp_us, bool key) = 0;  // VideoInvalid
  virtual Status flush() = 0;  // outputs all pictures; the next sample must be a keyframe
  virtual void reset() = 0;
};

}  // namespace fourdvt::platform
