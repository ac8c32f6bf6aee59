// SPDX-License-Identifier: Apache-2.0
// View transforms, viewport and near and far planes, in world and character frames.
#pragma once

#include <glm/glm.hpp>

#include "base/camera.h"

namespace fourdvt::render {

struct View {
  glm::mat4 clip_from_world{1};
  glm::vec3 eye_in_world{0};
  int width = 0, height = 0;  // pixels
};

// View in a character's frame.
struct CharacterView {
  glm::mat4 clip_from_character{1};
  glm::vec3 eye_in_character{0};
  int width = 0, height = 0;  // pixels
  glm::vec2 origin{0};        // view pixel, from below, at the drawn target's corner (FigureRegion)
};

// Returns the unit optical axis in the matrix's source frame: the gradient of clip w.
inline glm::vec3 viewAxis(const glm::mat4& clip_from_frame) {
  const glm::mat4& m = clip_from_frame;
  return glm::normalize(glm::vec3(m[0][3], m[1][3], m[2][3]));
}

// Minimum and maximum length scale of the characters in a view (CharacterModel::length_scale).
struct LengthScales {
  float least = 1, most = 1;
};

// Places the near plane at 5 cm and the far plane at 100 m, times the scales.
inline View viewFromCamera(const PinholeCamera& camera, const LengthScales& scales = {}) {
  const double near_m = 0.05 * double(scales.least), far_m = 100.0 * double(scales.most);
  return {glm::mat4(clipFromWorld(camera, near_m, far_m)), glm::vec3(camera.centreInWorld()), camera.width,
          camera.height};
}

}  // namespace fourdvt::render
