// SPDX-License-Identifier: Apache-2.0
// Where the character stands on the ground: placed by the page, turned towards a wanted heading, moved by the root
// motion of the frames shown. During a fade between two states both tracks move it, each by its share, and the
// placement goes over from the source's place to the target's along the shift between them, so that it does not jump.
// Does NOT choose frames and does NOT know the clock.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "motion/placement.h"
#include "package/character.h"
#include "player/parts/frame_geometry.h"

namespace fourdvt {

class RootMotion {
 public:
  enum class Side { Source, Target };  // the track that a step is of; without a fade there is the source only

  explicit RootMotion(double turn_rate_rad_s) : turn_rate_rad_s_(turn_rate_rad_s) {}

  void setTravel(bool on) { travel_ = on; }  // off: steps do not move the character
  // Non-finite values are ignored. Placing ends steering.
  void place(const motion::Placement& placement);
  void steer(double heading_rad);
  void turn(double dt_s);  // towards the wanted heading

  // A step in the character's frame: metres along x and z, radians about y.
  void move(const glm::vec3& step, Side side);
  const motion::Placement& placement() const { return placement_; }
  // Of the source's character frame, in which the mesh is drawn; without a fade as placement().
  motion::Placement sourcePlacement() const;

  // shift: the target's character frame seen from the source's, as of motion::Entry.
  void beginFade(const glm::vec3& shift);
  void setFade(float fade);               // the target's share, 0..1
  void finishFade() { fading_ = false; }  // the target is the source from now on
  void cancelFade();                      // the source stays where it is

 private:
  void setSourcePlacement(const motion::Placement& placement);

  double turn_rate_rad_s_;
  motion::Placement placement_;
  std::optional<double> wanted_heading_rad_;
  bool travel_ = false, fading_ = false;
  glm::vec3 shift_{0};
  float fade_ = 0;
};

// A frame that a track is about to show.
struct RootFrame {
  const package::Sequence& sequence;
  std::span<const float> weights;  // one a member
  const FrameGeometry& geometry;
};

// Root values of the frame that a track shows, per member: what the next frame's are compared with.
class RootTrail {
 public:
  // Moves the character from the kept frame to this one, which lies `passes` ends of the loop later.
  void lead(RootMotion& motion, RootMotion::Side side, const RootFrame& to, int64_t passes) const;
  void keep(const RootFrame& frame);

 private:
  std::array<glm::vec3, package::kMaxMembers> roots_{};
};

}  // namespace fourdvt
