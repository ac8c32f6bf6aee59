// SPDX-License-Identifier: Apache-2.0
// Alpha channels of videos: in the pictures (ProRes 4444, PNG, QuickTime Animation, FFV1 …), or beside them in blocks
// of WebM (VP8, VP9), which libvpx decodes and FFmpeg's own decoders leave out. HEVC's alpha layer is recognised only.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/image.h"
#include "base/result.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

enum class AlphaKind { None, InPictures, InBlocks, HevcLayer };

// By the container's and the decoder's headers; the channel may be opaque throughout.
AlphaKind alphaKindOf(const AVStream& stream);

// The decoder that returns a stream's alpha too; `usual` where that one does. Errors: FileUnreadable (this build
// decodes no alpha of the stream), naming `path`.
Result<const AVCodec*> decoderWithAlpha(const AVStream& stream, const AVCodec* usual, const std::string& path);

// The alpha of a decoded picture as one channel, 0 … 255; empty where its format has none.
Image alphaOf(const AVFrame& frame);

// True for an empty one, too.
bool isOpaque(const Image& alpha);
// RGBA; opaque without `alpha`.
Image withAlpha(const Image& rgb, const Image& alpha);

// Returns true if an HEVC decoder configuration record (hvcC, ISO/IEC 14496-15) announces an alpha layer: it holds the
// SEI message "alpha channel information". Bytes that are cut off end the search.
bool hevcConfigHasAlpha(std::span<const uint8_t> hvcc);

}  // namespace fourdvt::platform
