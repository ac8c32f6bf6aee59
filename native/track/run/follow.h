// SPDX-License-Identifier: Apache-2.0
// Fits of the template to the frames of a run, along the tree of similar frames.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "track/order.h"
#include "track/run/prepare.h"

namespace fourdvt::track {

// Thumbnails of all frames. Errors: those of stored pictures.
Result<std::vector<FrameThumbnails>> thumbnailsOf(const Work& work);

// Steps from the template's frame to all others.
std::vector<TrackingStep> orderOf(const Prepared& job, const Work& work, const ChosenTemplate& chosen,
                                  std::span<const FrameThumbnails> thumbnails);

class Follower {
 public:
  // Borrows all arguments. Errors: those of surfaces and stored pictures.
  static Result<Follower> create(const Prepared& job, const Work& work, const ChosenTemplate& chosen);

  // Fits one frame unless it is fitted; that of its parent must be. Returns true for a new fit. Errors: those of
  // surfaces and stored pictures; Internal (no parent); WriteFailed.
  Result<bool> follow(uint32_t frame, uint32_t parent);

  // Fits a frame again from another parent, and keeps the better fit. Returns true if that is the new one.
  Result<bool> repair(uint32_t frame, uint32_t parent);

 private:
  Follower(const Prepared& job, const Work& work, const ChosenTemplate& chosen, Template model)
      : job_(job), work_(work), chosen_(chosen), model_(std::move(model)) {}
  Result<TrackedFrame> fitted(uint32_t frame, uint32_t parent);

  const Prepared& job_;
  const Work& work_;
  const ChosenTemplate& chosen_;
  Template model_;
  FramePictures anchor_;
};

// Repairs bad fits from good ones of similar frames, the most similar first, until none improves.
Status repairFits(Follower& follower, const Work& work, std::span<const FrameThumbnails> thumbnails,
                  const std::function<Status(uint32_t frame)>& progress);

}  // namespace fourdvt::track
