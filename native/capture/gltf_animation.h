// SPDX-License-Identifier: Apache-2.0
// Node poses of a glTF file at an instant of its animation.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <vector>

#include "capture/gltf_bytes.h"
#include "capture/mesh_file.h"

namespace fourdvt::capture {

struct GltfPose {
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
  std::optional<glm::dmat4> matrix;            // replaces the three
  std::optional<std::vector<double>> weights;  // morph target weights; nullopt: the mesh's own
  glm::dmat4 parentFromNode() const;
};

// Poses of all nodes: as stored, then moved by the animation that `instant` selects, by the rules of glTF 2.0 (appendix
// C: step, linear, cubic spline; held before the first and after the last key). Errors: FileUnreadable; Unsupported
// (several animations, a file of one frame whose animation continues); VideoTooShort (the animation ends before the
// instant).
Result<std::vector<GltfPose>> gltfPoses(GltfBytes& bytes, const MeshInstant& instant);

}  // namespace fourdvt::capture
