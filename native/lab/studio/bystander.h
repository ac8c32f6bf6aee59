// SPDX-License-Identifier: Apache-2.0
// Second person, a distractor for captures: the procedural actor, smaller and in other colours, walking on the spot
// behind the ring's cameras. Visible in the cameras across from it, beside or behind the performer, never in front.
// Absent from mattes, held-out pictures and truth.
#pragma once

#include <memory>

#include "lab/studio/actors/actor.h"
#include "lab/studio/renderer.h"
#include "lab/studio/rig.h"

namespace fourdvt::studio {

class Bystander {
 public:
  // `drawn`: a camera of draw()'s picture size. Errors: GpuFailure.
  static Result<std::unique_ptr<Bystander>> create(gpu::Device& device, const Rig& rig, double ground_y_m,
                                                   uint32_t seed, const PinholeCamera& drawn);
  void pose(double time_s);
  const Positions& positions() const { return positions_; }  // world coordinates, as of pose()
  const std::vector<glm::uvec3>& faces() const { return actor_->surface().topology.face_vertices; }
  Result<Image> draw(const PinholeCamera& camera);  // premultiplied RGBA

 private:
  Bystander() = default;

  std::unique_ptr<Actor> actor_;
  std::unique_ptr<Renderer> renderer_;
  glm::dvec3 place_{0}, sideways_{0};  // position; horizontal unit vector, perpendicular to the line to the middle
  double near_m_ = 0, far_m_ = 0;
  Positions positions_;
};

// Composites `over`, premultiplied RGBA, over `behind`, RGB.
Image composed(const Image& over, const Image& behind);

}  // namespace fourdvt::studio
