// SPDX-License-Identifier: Apache-2.0
// Chooses libavcodec's encoder for a codec, and its options. Private to encode*.cpp.
#pragma once

#include "bake/video/encode.h"

extern "C" {
#include <libavcodec/avcodec.h>
}

namespace fourdvt::bake {

enum class Pass { Only, First, Second };

// Errors: Unsupported, with the package to install; InvalidArgument (preset).
Result<const AVCodec*> findEncoder(const EncodeSettings& settings);
bool encodesInTwoPasses(const EncodeSettings& settings);
// Does everything but call avcodec_open2 and hand over the first pass's statistics. Errors: InvalidArgument (`extra`).
Status configureEncoder(const EncodeSettings& settings, Pass pass, AVCodecContext& context);

}  // namespace fourdvt::bake
