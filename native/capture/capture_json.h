// SPDX-License-Identifier: Apache-2.0
// Parser of capture.json, and of its "classes" alone (class_json.cpp); opens no other file.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// Sequence as declared. All paths are absolute.
struct DeclaredSequence {
  CaptureSequence sequence;     // mesh_pattern is empty unless given by "mesh"
  bool without_meshes = false;  // "mesh": null
  std::string packed_topology;  // OBJ with faces and UVs for packed positions; else empty
};

struct DeclaredCapture {
  Capture capture;         // without cameras, sequences, topology and kind of meshes; with all classes
  bool per_frame = false;  // "topology": "per-frame"
  std::vector<DeclaredSequence> sequences;
  std::map<std::string, double> skew;  // by camera name, pixels
  Orientation orientation = Orientation::BySize;
};

// Parses capture.json in `folder`. Lengths are in the declared units, root velocities in those units per second.
// Errors: CaptureJson.
Result<DeclaredCapture> parseCaptureJson(std::string_view text, const std::string& folder);

inline constexpr size_t kMinMembers = 2, kMaxMembers = 4;  // members per class

// Motions with a common parameter, as declared. `list`: value of "classes", null without one. `file`: path of
// capture.json, for messages. Errors: CaptureJson.
Result<std::vector<CaptureClass>> parseClasses(const nlohmann::json& list,
                                               const std::vector<DeclaredSequence>& sequences, const std::string& file);

// Value of "classes" from which parseClasses reads `classes`, without footsteps.
nlohmann::ordered_json classesJson(const std::vector<CaptureClass>& classes);

}  // namespace fourdvt::capture
