// SPDX-License-Identifier: Apache-2.0
#include "bake/room/room_fill.h"

namespace fourdvt::bake {

glm::vec3 RoomFill::at(const glm::vec3& point) const {
  const float nearest2 = static_cast<float>(grain_m_ * grain_m_);
  glm::vec3 sum(0);
  float total = 0;
  for (const Known& k : known_) {
    const glm::vec3 d = k.point - point;
    const float distance2 = glm::dot(d, d) + nearest2, weight = k.weight / (distance2 * distance2);
    sum += weight * k.colour;
    total += weight;
  }
  return total > 0 ? sum / total : glm::vec3(0.5f);
}

}  // namespace fourdvt::bake
