// SPDX-License-Identifier: Apache-2.0
// Selects cameras of a capture where a character cannot hold all. Uses camera parameters and the surface only.
#pragma once

#include <string>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// At most `most` cameras, ascending; all where there are no more. The first one shows the largest part of the surface
// with the most pixels; each further one is the farthest in direction from those selected (farthest-point sampling).
// Angles have less weight where the camera shows less of the surface, or with fewer pixels per metre than half of the
// cameras do. Deterministic. Cameras that do not see the surface are left out.
std::vector<size_t> chooseCameras(const std::vector<PinholeCamera>& cameras, const Positions& surface, size_t most);

// Indices of cameras by name, ascending. Errors: InvalidArgument (an unknown name; the message lists the known ones).
Result<std::vector<size_t>> camerasByName(const std::vector<PinholeCamera>& cameras,
                                          const std::vector<std::string>& names);

}  // namespace fourdvt::bake
