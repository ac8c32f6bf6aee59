// SPDX-License-Identifier: Apache-2.0
// Live H.264 encoding, and the manifest of a live stream.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/result.h"
#include "live/rig/rig.h"
#include "live/server/tiles.h"

namespace fourdvt::live {
struct EncoderRules {
  int width = 0, height = 0;  // even
  double fps = 25;
  int crf = 23;
  const char* preset = "superfast";  // preset of libx264
  int threads = 1;
};

struct EncodedPicture {
  bool key = false;
  std::vector<uint8_t> sample;
};

class LiveEncoder {
 public:
  // Errors: Unsupported (this FFmpeg has no libx264, with what to install), InvalidArgument (rejected by libx264).
  static Result<std::unique_ptr<LiveEncoder>> create(const EncoderRules& rules);
  virtual ~LiveEncoder() = default;
  // Encodes a BT.709, limited-range picture of the rules' size as one Annex B sample, without delay or reordering. Keys
  // carry their parameter sets; the first picture is a key. Errors: Internal; the next picture is then a key.
  virtual Result<EncodedPicture> encode(const I420View& picture, bool key) = 0;
  virtual void setCrf(int crf) = 0;  // takes effect at the next key
  // RFC 6381, "avc1.…", from the parameter sets; constant for the encoder's lifetime.
  virtual const std::string& codec() const = 0;
};

constexpr uint32_t kMaxVertices = 65536, kMaxFaces = 65536;  // maximum of any frame
constexpr float kPositionStep_m = 0.001f;

struct ManifestInput {
  std::string session;  // 16 hexadecimal digits, new at every start
  std::string codec;    // RFC 6381
  PackedSize size;
};

// Manifest of a live stream, JSON, which viewers receive before its frames: FORMAT.md, "A live stream".
std::string liveManifest(const Rig& rig, const ManifestInput& input);

}  // namespace fourdvt::live
