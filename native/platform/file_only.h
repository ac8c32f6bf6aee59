// SPDX-License-Identifier: Apache-2.0
// Opens a media file of unknown origin without following references to other files, such as playlists. Private to the
// files that link FFmpeg.
#pragma once

#include <string>

#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

struct FileOnly {
  AvIo io;          // null: cannot be opened
  AvFormat format;  // null: unknown format, or it references other files
};

// Returns true for an MP4 or MOV that ends before its index ("moov"), as an interrupted recording does.
bool lacksIndex(const std::string& path);

// Opens the file without probing its streams.
FileOnly openFileOnly(const std::string& path);
// Probes the streams, which decodes pictures; limits their size to kMaxVideoPixels.
bool findStreams(AVFormatContext& format);

}  // namespace fourdvt::platform
