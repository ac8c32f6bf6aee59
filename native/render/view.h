// SPDX-License-Identifier: Apache-2.0
// Where a picture looks from, as shaders want it.
#pragma once

#include <glm/glm.hpp>

#include "base/camera.h"

namespace fourdvt::render {

struct View {
  glm::mat4 clip_from_world{1};
  glm::vec3 eye_in_world{0};
  int width = 0, height = 0;  // pixels
};

// The same in the frame of a character that stands in the world.
struct CharacterView {
  glm::mat4 clip_from_character{1};
  glm::vec3 eye_in_character{0};
  int width = 0, height = 0;  // pixels
  glm::vec2 origin{0};        // pixel of the view, from below, that the drawn target begins at (FigureRegion)
};

// Unit optical axis in the frame that the matrix starts from: the gradient of clip w.
inline glm::vec3 viewAxis(const glm::mat4& clip_from_frame) {
  const glm::mat4& m = clip_from_frame;
  return glm::normalize(glm::vec3(m[0][3], m[1][3], m[2][3]));
}

// The smallest and the largest length scale of the characters that a view shows (CharacterModel::length_scale).
struct LengthScales {
  float least = 1, most = 1;
};

// Sees from 5 cm to 100 m, times the scales.
inline View viewFromCamera(const PinholeCamera& camera, const LengthScales& scales = {}) {
  const double near_m = 0.05 * double(scales.least), far_m = 100.0 * double(scales.most);
  return {glm::mat4(clipFromWorld(camera, near_m, far_m)), glm::vec3(camera.centreInWorld()), camera.width,
          camera.height};
}

}  // namespace fourdvt::render
