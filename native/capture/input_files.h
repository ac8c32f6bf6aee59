// SPDX-License-Identifier: Apache-2.0
// Digests of the files that frames of a sequence are read from, by name, size and time; contents are not read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// Hash of name, size and time (whole seconds: file systems round it differently) of every picture, matte and mesh file
// for frames first…end-1. Excludes files common to all frames: calibration, plates, capture.json.
uint64_t inputDigest(const Capture& capture, const CaptureSequence& sequence, uint32_t first, uint32_t end);

// Hash of all meshes of a sequence, of the sounds, and of the other files common to all frames.
uint64_t meshDigest(const CaptureSequence& sequence);
uint64_t soundDigest(const Capture& capture);
uint64_t commonInputDigest(const Capture& capture);

// Paths of all videos with the capture's pictures and mattes.
std::vector<std::string> videoFiles(const Capture& capture);

}  // namespace fourdvt::capture
