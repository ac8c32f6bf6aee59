// SPDX-License-Identifier: Apache-2.0
// Alpha channels of videos: in the pictures (ProRes 4444, PNG, QuickTime Animation, FFV1 …), or beside them in blocks
// of WebM (VP8, VP9), decoded by libvpx only. HEVC's alpha layer is detected but not decoded.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/image.h"
#include "base/result.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

enum class AlphaKind { None, InPictures, InBlocks, HevcLayer };

// Alpha kind by the container's and the decoder's headers; the channel may be opaque throughout.
AlphaKind alphaKindOf(const AVStream& stream);

// Decoder that also returns a stream's alpha: `usual` if it does. Errors: FileUnreadable (this build decodes no alpha
// of the stream), naming `path`.
Result<const AVCodec*> decoderWithAlpha(const AVStream& stream, const AVCodec* usual, const std::string& path);

// Alpha of a decoded picture as one channel, 0 … 255; empty if its format has none.
Image alphaOf(const AVFrame& frame);

// Returns true for an empty picture, too.
bool isOpaque(const Image& alpha);
// RGBA; opaque without `alpha`.
Image withAlpha(const Image& rgb, const Image& alpha);

// Returns true if an HEVC decoder configuration record (hvcC, ISO/IEC 14496-15) announces an alpha layer by the SEI
// message "alpha channel information". Truncated bytes end the search.
bool hevcConfigHasAlpha(std::span<const uint8_t> hvcc);

}  // namespace fourdvt::platform
