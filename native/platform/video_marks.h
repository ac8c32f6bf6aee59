// SPDX-License-Identifier: Apache-2.0
// Marks in a video's header and its decoded pictures. Private to the files that link FFmpeg.
#pragma once

#include <optional>
#include <string>

#include "base/picture_marks.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

// Display matrix and sample aspect ratio of a stream. Nothing: the matrix turns by no quarter.
std::optional<PictureMarks> marksOf(AVFormatContext& format, AVStream& stream);

// A conversion of pictures by FFmpeg's filters, and its name in reports. No chain: none is needed.
struct Conversion {
  std::string chain, name;
};

// Two fields an instant apart → one picture, of the first one's instant.
Conversion deinterlacing(const AVStream& stream, const AVFrame& first);

// HLG, PQ, BT.2020, P3 → BT.709 as sRGB displays show it: RGB, a diffuse white of 203 cd/m² (BT.2408) is white, what is
// brighter is compressed.
Conversion toBt709(const AVFrame& frame);

}  // namespace fourdvt::platform
