// SPDX-License-Identifier: Apache-2.0
// Which of a capture's cameras a character keeps where it cannot hold all. Does NOT look at pictures.
#pragma once

#include <string>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// At most `most` cameras, ascending; all where there are no more. First the one that shows the most of the surface with
// the most pixels, then again and again the one farthest in direction from those chosen; an angle counts less where the
// camera shows less of the surface, or with fewer pixels per metre than half of the cameras do. The same input gives
// the same choice. Cameras that do not see the surface are left out.
std::vector<size_t> chooseCameras(const std::vector<PinholeCamera>& cameras, const Positions& surface, size_t most);

// Indices of cameras by name, ascending. Errors: InvalidArgument (a name that none has, with those that are known).
Result<std::vector<size_t>> camerasByName(const std::vector<PinholeCamera>& cameras,
                                          const std::vector<std::string>& names);

}  // namespace fourdvt::bake
