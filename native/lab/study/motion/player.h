// SPDX-License-Identifier: Apache-2.0
// Plays a baked character with the real player, tick by tick, and keeps the mesh and the picture shown.
#pragma once

#include <memory>
#include <string>

#include "lab/study/motion/stage.h"

namespace fourdvt::study {

constexpr double kTick_s = 1.0 / 25;

// Change from one tick to the next.
struct TickChange {
  double step_m = 0;  // maximum movement of a vertex in the world, travel included if the player travels
  double levels = 0;  // pictureChange
};

class WatchedPlayer {
 public:
  // travel: root motion moves the character; otherwise it stays in place, and its pictures are recorded.
  static Result<std::unique_ptr<WatchedPlayer>> open(gpu::Device& device, const std::string& folder, bool travel);
  Player& player() { return player_->player(); }
  // Sets a class's `parameter` (NaN: unchanged) and plays on from this frame.
  Status start(const std::string& state, uint32_t frame, double parameter);
  Result<TickChange> tick();
  const Positions& world() const { return world_; }  // as shown
  const Image& picture() const { return picture_; }  // empty while travelling
  // Middle of the first parameter's range; NaN for a plain sequence.
  static double middleParameter(const package::Sequence& sequence);

 private:
  WatchedPlayer(gpu::Device& device, bool travel) : device_(device), travel_(travel) {}
  Status look();

  gpu::Device& device_;
  const bool travel_;
  std::unique_ptr<edge::CharacterPlayer> player_;
  Positions world_;
  Image picture_;
};

}  // namespace fourdvt::study
