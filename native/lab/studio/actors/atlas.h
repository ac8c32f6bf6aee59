// SPDX-License-Identifier: Apache-2.0
// Texture atlas for a mesh of slender parts. A chart holds connected faces of one part with one facing direction; it is
// projected along that direction and packed without overlap. Distortion is not minimised: faces lean by up to about
// 55°.
#pragma once

#include <functional>

#include "lab/studio/actors/actor.h"

namespace fourdvt::studio {

// Sets the topology's uvs and face_uvs, in [0,1]. `part` returns the part of a point of the rest pose.
void unwrap(RestMesh& mesh, const std::function<int(const glm::vec3&)>& part);

}  // namespace fourdvt::studio
