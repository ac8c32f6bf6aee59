// SPDX-License-Identifier: Apache-2.0
// The video codecs that the bake knows. A new one needs an entry here (and in kCodecs), and:
//   encode_setup.cpp, encode.cpp   its encoder, whether it takes two passes, its parameter sets
//   mp4.cpp                        its codec string (describeCodec)
//   bake/quality.cpp               CRF and preset of every --quality
//   bake/run/renditions.cpp        how many steps of CRF halve its bitrate
//   platform/ffmpeg_decoder.cpp    its decoder
//   tools/bake_command.cpp         the help texts of --codec and --crf
//   study/steps/rate.cpp           its rate curve
//   the lists of codecs in encode_test.cpp, quality_test.cpp and cli_bake_test.cpp
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace fourdvt::bake {

enum class Codec { H264, Vp9, Av1 };
constexpr size_t kCodecs = 3;

struct CodecInfo {
  const char* name;            // as --codec takes it; also FFmpeg's name
  const char* kind;            // what its RFC 6381 strings begin with
  int highest_crf;             // on the codec's own scale, which starts at 0
  const char* default_preset;  // what an empty EncodeSettings::preset means
  const char* presets;         // one line for help and messages
  // By how many frames decoding order may run ahead of presentation order, the same in every GOP. VP9 and AV1 hide
  // their reordering inside packets.
  int reorder_frames;
};

inline constexpr std::array<CodecInfo, kCodecs> kCodecInfos{{
    {"h264", "avc1", 51, "slower", "ultrafast, superfast, veryfast, faster, fast, medium, slow, slower or veryslow", 1},
    {"vp9", "vp09", 63, "3", "0 (slow) to 5", 0},
    {"av1", "av01", 63, "6", "0 (slow) to 7 for SVT-AV1, aom-0 to aom-8 for libaom", 0},
}};

constexpr const CodecInfo& infoOf(Codec codec) { return kCodecInfos[static_cast<size_t>(codec)]; }

// "h264, vp9, av1"
std::string codecNames();
// False: there is no such name.
bool parseCodec(const std::string& name, Codec& codec);

}  // namespace fourdvt::bake
