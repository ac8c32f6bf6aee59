// SPDX-License-Identifier: Apache-2.0
// Time stamps of a video's pictures, from the container's index or from its packets: nothing is decoded. Private to the
// files that link FFmpeg.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

struct VideoStamps {
  // In the stream's time base and in the order of presentation, of the pictures that are shown: not those that an edit
  // list hides, nor those that the end of the file cuts off.
  std::vector<int64_t> times;
  bool presentation = false;  // unique presentation times, which number the pictures; else the order of storing
  bool from_index = false;    // equal intervals from the index; the first one may be another than the first picture's
  bool cut_off = false;       // the file ends before or inside of a picture
};

// Lists them from the index where that has all pictures at equal intervals, else reads all packets, which moves the
// file's position. What was read is kept in the file `kept` (stampsPath; empty: nowhere) for whoever lists it again; a
// damaged one is made again.
VideoStamps listStamps(AVFormatContext& format, int stream, const std::string& kept);

// True for a packet that the end of the file cuts off.
bool isCutOff(const AVFormatContext& format, const AVPacket& packet);

// Path of a video's kept list, from its name, size and time; empty where `folder` is no folder.
std::string stampsPath(const std::string& video, const std::string& folder);

// The video track that is read: by its flags, then of colour before grey, then the first one; -1: none that this build
// decodes. Cover pictures are no video.
int pictureTrack(const AVFormatContext& format);

// Everything that the container gives, with the stamps.
VideoListing listVideo(const AVFormatContext& format, int stream, const VideoStamps& stamps);

}  // namespace fourdvt::platform
