// SPDX-License-Identifier: Apache-2.0
// The files that frames of a sequence are read from. Does NOT read them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// Hash of name, size and time (whole seconds: file systems round it differently) of every picture, matte and mesh file
// that frames first…end-1 are read from. Files that all frames need are not in it: calibration, plates, capture.json.
uint64_t inputDigest(const Capture& capture, const CaptureSequence& sequence, uint32_t first, uint32_t end);

// The same of all meshes of a sequence, of the sounds, and of the other files that all frames need.
uint64_t meshDigest(const CaptureSequence& sequence);
uint64_t soundDigest(const Capture& capture);
uint64_t commonInputDigest(const Capture& capture);

// Paths of all videos that the capture's pictures and mattes come from.
std::vector<std::string> videoFiles(const Capture& capture);

}  // namespace fourdvt::capture
