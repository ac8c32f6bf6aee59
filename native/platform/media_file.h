// SPDX-License-Identifier: Apache-2.0
// Media file of unknown origin: opens it without following references to other files, such as playlists, and lists the
// time stamps of its pictures, from the container's index or its packets, without decoding. Private to the files that
// link FFmpeg.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/video.h"
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

struct VideoStamps {
  // Times of the shown pictures in the stream's time base, in presentation order; excludes pictures hidden by an edit
  // list or truncated by the end of the file.
  std::vector<int64_t> times;
  bool presentation = false;  // unique presentation times, which number the pictures; else storage order
  bool from_index = false;    // equal intervals from the index; the first may differ from the first picture's
  bool cut_off = false;       // the file ends before or inside a picture
};

// Lists stamps from the index if it has all pictures at equal intervals, else reads all packets, which moves the file's
// position. Caches the packets' stamps in the file `kept` (stampsPath; empty: no cache) and replaces a damaged one.
VideoStamps listStamps(AVFormatContext& format, int stream, const std::string& kept);

// Returns true for a packet truncated by the end of the file.
bool isCutOff(const AVFormatContext& format, const AVPacket& packet);

// Path of a video's cached list, from its name, size and time; empty if `folder` is no folder.
std::string stampsPath(const std::string& video, const std::string& folder);

// Selects the video track to read: by its flags, then colour before grey, then the first one. Cover pictures do not
// count. -1: this build decodes no track.
int pictureTrack(const AVFormatContext& format);

// Lists the container's metadata and the stamps.
VideoListing listVideo(const AVFormatContext& format, int stream, const VideoStamps& stamps);

}  // namespace fourdvt::platform
