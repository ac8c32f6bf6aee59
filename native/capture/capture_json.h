// SPDX-License-Identifier: Apache-2.0
// Reads what capture.json declares. Does NOT look at any other file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// All paths are absolute.
struct DeclaredSequence {
  CaptureSequence sequence;
  std::string
      packed_topology;  // the OBJ with faces and UVs that goes with packed positions; empty if every frame is an OBJ
};

struct DeclaredCapture {
  Capture capture;  // without cameras, sequences and topology; with all classes
  std::string cameras_folder;
  std::vector<DeclaredSequence> sequences;
};

// `folder` holds capture.json. Lengths are in the declared units, root velocities in those units per second.
// Errors: CaptureJson.
Result<DeclaredCapture> parseCaptureJson(std::string_view text, const std::string& folder);

}  // namespace fourdvt::capture
