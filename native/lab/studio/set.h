// SPDX-License-Identifier: Apache-2.0
// Studio set for one run: actor, mesh tracker, cameras and renderer, posed together.
#pragma once

#include <memory>
#include <optional>

#include "lab/studio/actors/actor.h"
#include "lab/studio/bystander.h"
#include "lab/studio/lens.h"
#include "lab/studio/renderer.h"
#include "lab/studio/rig.h"
#include "lab/studio/tracker.h"

namespace fourdvt::studio {

// Number of frames of a motion at this rate. The last frame of a loop lies one step before its first; the last frame of
// any other motion is its end.
uint32_t frameCount(const Motion& motion, double fps);
// Number of its frames that are filmed.
uint32_t filmedFrames(const Motion& motion, const StudioOptions& options);
// Phase of one of these frames, 0…1. Loops wrap times before the first and after the last frame; other motions hold
// their first and last pose there.
double framePhase(const Motion& motion, double frame, uint32_t count);

class StudioSet {
 public:
  static Result<std::unique_ptr<StudioSet>> open(const StudioOptions& options, gpu::Device& device);

  const Actor& actor() const { return *actor_; }
  const Tracker& tracker() const { return tracker_; }
  const Rig& rig() const { return rig_; }
  const std::vector<StudioClass>& classes() const { return classes_; }
  const BoundingBox& bounds() const { return bounds_; }
  double groundY_m() const { return bounds_.min.y; }
  const Positions& surfacePose() const { return surface_pose_; }  // actor's surface, as of pose()
  double unitsPerMetre() const { return units_per_metre_; }       // scale of packed positions
  size_t motionIndex(const std::string& name) const;
  // Shares of all motions at a position between the members of a class: 0 is the first, 1 the last, linear between
  // neighbours.
  std::vector<double> sharesAt(const StudioClass& motion_class, double position) const;

  Bystander* bystander() { return bystander_.get(); }  // null: no bystander

  // Poses all members at an instant.
  void pose(const std::vector<double>& shares, double phase);
  const Lens& lens() const { return *lens_; }       // lens of the ring's cameras
  Result<Image> draw(const PinholeCamera& camera);  // premultiplied RGBA
  Result<Image> film(const PinholeCamera& camera);  // draw() through the lens
  Positions truth() const { return tracker_.truth(points_, surface_pose_); }
  Positions captured() const { return tracker_.captured(points_, surface_pose_); }
  double placeOf(const std::vector<double>& shares) const;

 private:
  StudioSet(const StudioOptions& options, std::unique_ptr<Actor> actor);
  Status chooseClasses(const StudioOptions& options);
  void measure(const StudioOptions& options);
  Status openFilm(const StudioOptions& options, gpu::Device& device);

  std::unique_ptr<Actor> actor_;
  Image texture_;  // texture of the drawn actor
  const Tracker tracker_;
  const Shading shading_;
  std::vector<StudioClass> classes_;
  std::vector<double> places_;  // [motion] position for drift and folds, 0…1
  Rig rig_;
  BoundingBox bounds_;
  double units_per_metre_ = 0;
  std::optional<Lens> lens_;
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<Bystander> bystander_;
  std::unique_ptr<Renderer> film_renderer_;  // draws the lens's input pictures; null without a lens
  Positions surface_pose_;
  std::vector<SurfacePoint> points_;
};

}  // namespace fourdvt::studio
