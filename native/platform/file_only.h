// SPDX-License-Identifier: Apache-2.0
// Opens a media file of unknown origin without opening any other file that it names, as playlists do. Private to the
// files that link FFmpeg.
#pragma once

#include <string>

#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

struct FileOnly {
  AvIo io;          // null: it cannot be opened
  AvFormat format;  // null: its format is not known, or names other files
};

// True for an MP4 or MOV that ends before its index ("moov"), as a recording does that was cut off.
bool lacksIndex(const std::string& path);

// Streams are not looked for yet.
FileOnly openFileOnly(const std::string& path);
// Probes the streams. Probing decodes pictures, with decoders of its own: none larger than a video may have.
bool findStreams(AVFormatContext& format);

}  // namespace fourdvt::platform
