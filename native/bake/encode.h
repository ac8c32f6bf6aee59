// SPDX-License-Identifier: Apache-2.0
// H.264 through libx264, one closed GOP at a time: every GOP has a fresh encoder with the same settings, so that GOPs
// do not depend on each other (resume, order of work) and share their parameter sets. Single-threaded inside: the bytes
// depend on the input only.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::bake {

struct EncodeSettings {
  int width = 0, height = 0;
  double fps = 25;
  int crf = 23;
};

struct EncodedPacket {
  uint32_t frame = 0;  // presentation index in the GOP
  bool key = false;
  std::vector<uint8_t> bytes;  // Annex B
};

struct EncodedGop {
  std::vector<uint8_t> parameter_sets;  // Annex B SPS and PPS
  std::vector<EncodedPacket> packets;   // decoding order
};

// Frames that decoding order may run ahead of presentation order, in every GOP.
constexpr int kReorderFrames = 1;

class GopEncoder {
 public:
  // Errors: Unsupported (no libx264), Internal.
  static Result<std::unique_ptr<GopEncoder>> create(const EncodeSettings& settings);
  virtual ~GopEncoder() = default;
  virtual Status push(const I420View& picture) = 0;
  // No push may follow.
  virtual Result<EncodedGop> finish() = 0;
};

}  // namespace fourdvt::bake
