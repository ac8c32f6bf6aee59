// SPDX-License-Identifier: Apache-2.0
// The manifest of a live stream, which viewers get before its frames: FORMAT.md, "A live stream". Does NOT read one.
#pragma once

#include <string>

#include "live/rig/rig.h"
#include "live/server/tiles.h"

namespace fourdvt::live {

constexpr uint32_t kMostVertices = 65536, kMostFaces = 65536;  // of any frame
constexpr float kPositionStep_m = 0.001f;

struct ManifestInput {
  std::string session;  // 16 hexadecimal digits, others at every start
  std::string codec;    // RFC 6381
  PackedSize size;
};

std::string liveManifest(const Rig& rig, const ManifestInput& input);

}  // namespace fourdvt::live
