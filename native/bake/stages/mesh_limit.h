// SPDX-License-Identifier: Apache-2.0
// The largest mesh that players hold in their textures, checked before long work.
#pragma once

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::bake {

// Side in texels of the largest texture that nearly every WebGL 2 device allows.
constexpr uint64_t kPlayersTextureSide = 4096;

// `file` names the mesh in messages. Errors: InvalidArgument.
Status checkLayeredMesh(const std::string& file, uint64_t vertices, uint64_t faces);
// A surface as it will be streamed: simplified already, where the bake does that.
Status checkSurface(const std::string& file, uint64_t vertices, uint64_t faces);

// Path of the frame's mesh, for messages.
std::string meshFile(const capture::CaptureSequence& sequence, uint32_t frame);

}  // namespace fourdvt::bake
