// SPDX-License-Identifier: Apache-2.0
// Colours for the parts of a room that no camera sees.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace fourdvt::bake {

// Continues known colours over a surface: at a point the mean of all that is known, by inverse distance to the power of
// four, so that what is near decides. Smooth in space, hence also across the edges of a box.
class RoomFill {
 public:
  explicit RoomFill(double grain_m) : grain_m_(grain_m) {}  // distances below this count as this
  // `weight`: how many texels the colour is the mean of.
  void add(const glm::vec3& point, const glm::vec3& colour, float weight) { known_.push_back({point, colour, weight}); }
  glm::vec3 at(const glm::vec3& point) const;  // mid-grey if nothing is known

 private:
  struct Known {
    glm::vec3 point, colour;
    float weight;
  };
  double grain_m_;
  std::vector<Known> known_;
};

}  // namespace fourdvt::bake
