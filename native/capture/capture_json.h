// SPDX-License-Identifier: Apache-2.0
// capture.json → what it declares. Does NOT look at any other file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// Paths are absolute once parsed.
struct DeclaredSequence {
  CaptureSequence sequence;
  std::string packed_topology;  // OBJ with faces and UVs beside packed positions; empty for OBJ frames
};

struct DeclaredCapture {
  Capture capture;  // without cameras, sequences and topology; with all classes
  std::string cameras_folder;
  std::vector<DeclaredSequence> sequences;
};

// `folder` holds capture.json. Lengths are in the declared units, root velocities in those units a second.
// Errors: CaptureJson.
Result<DeclaredCapture> parseCaptureJson(std::string_view text, const std::string& folder);

}  // namespace fourdvt::capture
