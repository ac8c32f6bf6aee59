// SPDX-License-Identifier: Apache-2.0
// Reads what capture.json declares. Does NOT look at any other file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// All paths are absolute.
struct DeclaredSequence {
  CaptureSequence sequence;     // its mesh_pattern is empty where there is no "mesh" that gives one
  bool without_meshes = false;  // "mesh": null
  std::string packed_topology;  // the OBJ with faces and UVs that goes with packed positions; else empty
};

struct DeclaredCapture {
  Capture capture;         // without cameras, sequences, topology and kind of meshes; with all classes
  bool per_frame = false;  // "topology": "per-frame"
  std::vector<DeclaredSequence> sequences;
  std::map<std::string, double> skew;  // by camera's name, pixels
  Orientation orientation = Orientation::BySize;
};

// `folder` holds capture.json. Lengths are in the declared units, root velocities in those units per second.
// Errors: CaptureJson.
Result<DeclaredCapture> parseCaptureJson(std::string_view text, const std::string& folder);

}  // namespace fourdvt::capture
