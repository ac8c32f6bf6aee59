// SPDX-License-Identifier: Apache-2.0
// Makes one texture atlas for a mesh of slender parts. A chart holds connected faces of one part that face the same
// way; it is laid flat along that direction and packed without overlap. Does NOT minimise distortion: faces lean by up
// to about 55°.
#pragma once

#include <functional>

#include "lab/studio/actors/actor.h"

namespace fourdvt::studio {

// Sets the topology's uvs and face_uvs, in [0,1]. `part` returns which part a point of the rest pose belongs to.
void unwrap(RestMesh& mesh, const std::function<int(const glm::vec3&)>& part);

}  // namespace fourdvt::studio
