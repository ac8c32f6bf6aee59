// SPDX-License-Identifier: Apache-2.0
// Fits of the template to the frames of a run, along the tree of similar frames.
#pragma once

#include <vector>

#include "track/order.h"
#include "track/run/prepare.h"

namespace fourdvt::track {

// Steps from the template's frame to all others. Errors: those of stored pictures.
Result<std::vector<TrackingStep>> orderOf(const Prepared& job, const Work& work, const ChosenTemplate& chosen);

class Follower {
 public:
  // Borrows all arguments. Errors: those of surfaces and stored pictures.
  static Result<Follower> create(const Prepared& job, Work& work, const ChosenTemplate& chosen);

  // Fits one frame unless it is fitted; that of its parent must be. Returns true for a new fit. Errors: those of
  // surfaces and stored pictures; Internal (no parent); WriteFailed.
  Result<bool> follow(uint32_t frame, uint32_t parent);

  // Fits a frame again from another parent, and keeps the better fit. Returns true if that is the new one.
  Result<bool> repair(uint32_t frame, uint32_t parent);

 private:
  Follower(const Prepared& job, Work& work, const ChosenTemplate& chosen, Template model)
      : job_(job), work_(work), chosen_(chosen), model_(std::move(model)) {}
  Result<TrackedFrame> fitted(uint32_t frame, uint32_t parent);

  const Prepared& job_;
  Work& work_;
  const ChosenTemplate& chosen_;
  Template model_;
  FramePictures anchor_;
};

// Repairs bad fits from good ones of similar frames, the most similar first, until none improves. Errors:
// InvalidArgument (a frame is not fitted); those of surfaces and stored pictures; Interrupted.
Status repairFits(Follower& follower, const Prepared& job, const Work& work, const TrackEnvironment& environment);

}  // namespace fourdvt::track
