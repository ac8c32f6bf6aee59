// SPDX-License-Identifier: Apache-2.0
// H.264, VP9 and AV1 through libavcodec, one closed GOP at a time: every GOP has a fresh encoder with the same
// settings, so that GOPs do not depend on each other (resume, order of work) and share their parameter sets.
// Single-threaded inside: the bytes depend on the input only. Memory: VP9 is encoded in two passes and holds the
// pictures of its GOP until finish(); the others hold their encoder's lookahead.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bake/video/codec.h"
#include "base/image.h"
#include "base/result.h"

namespace fourdvt::bake {

// H.264: x264's preset names. VP9: libvpx's cpu-used, 0..5. AV1: SVT-AV1's 0..7, or "aom-0".."aom-8" for libaom.
bool knowsPreset(Codec codec, const std::string& preset);

// Errors: Unsupported (no such encoder here, with the package to install), InvalidArgument (preset).
Status checkEncoder(Codec codec, const std::string& preset);

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

}  // namespace fourdvt::bake
