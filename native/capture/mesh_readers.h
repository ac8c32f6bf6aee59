// SPDX-License-Identifier: Apache-2.0
// One reader for each kind of mesh file, behind parseMesh, which checks what they return: indices may be out of range
// and positions not finite. `path` is for messages.
#pragma once

#include <string>
#include <string_view>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::capture {

Result<TriangleMesh> parsePly(std::string_view bytes, const std::string& path);
Result<TriangleMesh> parseGlb(std::string_view bytes, const std::string& path);
// Reads the buffers that the JSON names from the folder of `path`, and from nowhere else.
Result<TriangleMesh> parseGltf(std::string_view json, const std::string& path);

}  // namespace fourdvt::capture
