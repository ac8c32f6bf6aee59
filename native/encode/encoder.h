// SPDX-License-Identifier: Apache-2.0
// Encodes H.264, VP9 and AV1 through libavcodec, one closed GOP at a time: every GOP has a fresh encoder with the
// same settings, so that GOPs are independent of each other (resume, order of work) and share their parameter sets.
// Single-threaded inside: the bytes depend on the input only. Memory: VP9 is encoded in two passes and holds the
// pictures of its GOP until finish(); the others hold their encoder's lookahead.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::encode {

// A new codec needs an entry here and in kCodecInfos, and:
// encoder.cpp                    its encoder, its options, one pass or two, its parameter sets
// mp4.cpp                        its codec string (describeCodec)
// bake/quality.cpp               CRF and preset of every --quality
// bake/run/renditions.cpp        how many steps of CRF halve its bitrate
// platform/ffmpeg_decoder.cpp    its decoder
// tools/bake_command.cpp         the help texts of --codec and --crf
// lab/study/steps/rate.cpp       its rate curve
// the lists of codecs in encode_test.cpp, quality_test.cpp and cli_bake_test.cpp
enum class Codec { H264, Vp9, Av1 };
constexpr size_t kCodecs = 3;

struct CodecInfo {
  const char* name;            // value of --codec; also FFmpeg's name
  const char* kind;            // prefix of its RFC 6381 strings
  int highest_crf;             // on the codec's own scale, which starts at 0
  const char* default_preset;  // for an empty EncodeSettings::preset
  const char* presets;         // one line for help and messages
  // Maximum number of frames by which decoding order runs ahead of presentation order, the same in every GOP. VP9 and
  // AV1 hide their reordering inside packets.
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
// False for an unknown name.
bool parseCodec(const std::string& name, Codec& codec);

// H.264: x264's preset names. VP9: libvpx's cpu-used, 0..5. AV1: SVT-AV1's 0..7, or "aom-0".."aom-8" for libaom.
bool knowsPreset(Codec codec, const std::string& preset);

// Errors: Unsupported (no such encoder here, with the package to install), InvalidArgument (preset).
Status checkEncoder(Codec codec, const std::string& preset);

// First frames of GOPs of at most `gop` frames, whose lengths differ by at most 1.
std::vector<uint32_t> planGops(uint32_t frame_count, int gop);

struct EncodeSettings {
  int width = 0, height = 0;
  double fps = 25;
  int crf = 23;  // the codec's own scale: 0..51 for H.264, 0..63 for VP9 and AV1
  Codec codec = Codec::H264;
  std::string preset;  // the encoder's own, see knowsPreset; empty: the codec's default
  // Further options of the encoder, "key=value:key=value": x264-params, svtav1-params, options of libavcodec's
  // wrapper of libvpx and libaom. For measurements.
  std::string extra;
};

struct EncodedPacket {
  uint32_t frame = 0;  // presentation index in the GOP
  bool key = false;
  std::vector<uint8_t> bytes;  // H.264: Annex B; VP9: (super)frame; AV1: temporal unit
};

struct EncodedGop {
  std::vector<uint8_t> parameter_sets;  // Annex B SPS and PPS; VP9: empty; AV1: sequence header OBU
  std::vector<EncodedPacket> packets;   // decoding order
};

class GopEncoder {
 public:
  // Errors: Unsupported (no such encoder here), InvalidArgument (preset), Internal.
  static Result<std::unique_ptr<GopEncoder>> create(const EncodeSettings& settings);
  virtual ~GopEncoder() = default;
  virtual Status push(const I420View& picture) = 0;
  // Ends the GOP; no push may follow.
  virtual Result<EncodedGop> finish() = 0;
};

}  // namespace fourdvt::encode
