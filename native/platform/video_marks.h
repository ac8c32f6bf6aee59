// SPDX-License-Identifier: Apache-2.0
// Marks in a video's header and its decoded pictures. Private to the files that link FFmpeg.
#pragma once

#include <optional>
#include <string>

#include "base/image.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

// Display matrix and sample aspect ratio of a stream. nullopt: the rotation is no multiple of 90°.
std::optional<PictureMarks> marksOf(AVFormatContext& format, AVStream& stream);

// Picture conversion by FFmpeg's filters, and its name in reports. An empty chain means none is needed.
struct Conversion {
  std::string chain, name;
};

// Deinterlacing: two fields an instant apart → one picture, of the first one's instant.
Conversion deinterlacing(const AVStream& stream, const AVFrame& first);

// Tone mapping: HLG, PQ, BT.2020, P3 → BT.709 as sRGB displays show it: RGB, with diffuse white at 203 cd/m² (BT.2408)
// and brighter values compressed.
Conversion toBt709(const AVFrame& frame);

}  // namespace fourdvt::platform
