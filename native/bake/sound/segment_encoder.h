// SPDX-License-Identifier: Apache-2.0
// Encodes samples into a small media file in memory that browsers' decodeAudioData reads: Opus in WebM, AAC-LC in MP4.
// The same samples give the same bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::bake {

inline constexpr int kSoundRate = 48000;  // samples a second

enum class SoundCodec { Opus, Aac };
inline constexpr SoundCodec kSoundCodecs[] = {SoundCodec::Opus, SoundCodec::Aac};

struct SoundCodecInfo {
  const char* mime_type;  // with the RFC 6381 codec
  const char* extension;
};
const SoundCodecInfo& infoOf(SoundCodec codec);

struct EncodedSound {
  std::vector<uint8_t> bytes;
  uint32_t samples = 0;  // number decoded if the file's priming is honoured
  uint32_t priming = 0;  // extra samples before them from decoders that ignore it
};

// `samples`: interleaved, 1 or 2 channels at kSoundRate. Extends them with silence to the next whole number of codec
// blocks, so that the file has no padding at its end. Errors: Unsupported (an FFmpeg without the encoder), Internal.
Result<EncodedSound> encodeSegment(SoundCodec codec, std::span<const float> samples, int channels);

// Maximum number of silent samples that encodeSegment appends.
inline constexpr size_t kMaxPadding = 1024;

}  // namespace fourdvt::bake
