// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/filming.h"

#include <algorithm>

#include "lab/studio/random.h"

namespace fourdvt::studio {

std::vector<double> timeOffsets(const StudioOptions& options) {
  std::vector<double> out;
  for (int c = 0; c < options.cameras; ++c)
    out.push_back(options.knobs.offset_frames * randomNormal(options.knobs.seed, 0x0ff5e700 + uint64_t(c)));
  return out;
}

Filming::Filming(const StudioOptions& options, StudioSet& set)
    : options_(options), set_(set), offsets_(timeOffsets(options)) {
  const Rig& rig = set.rig();
  if (options.room)
    room_ = std::make_unique<Room>(options.knobs.seed, rig, set.groundY_m(), set.actor(), options.room_size_m,
                                   options.knobs.soft_shadow_m, set.lens());
  for (size_t c = 0; c < rig.ring.size(); ++c) {
    if (room_)
      sensors_.emplace_back(options.knobs, int(c), room_->empty(c));
    else
      sensors_.emplace_back(options.knobs, int(c), options.width, options.height);
  }
}

Image Filming::plate(size_t camera, uint32_t take) const {
  if (!room_) return sensors_[camera].plate();
  if (options_.knobs.plate_move_pixels == 0) return sensors_[camera].recordedPlate(take);
  const Image moved = room_->emptySeenBy(plateCameras(set_.rig().ring, options_.knobs)[camera]);
  return sensors_[camera].recordedPlate(take, &moved);
}

void Filming::begin(const Moment& moment) {
  moment_ = moment;
  pose(moment.frame);
}

void Filming::pose(double frame) {
  std::vector<double> shares(set_.actor().motions().size(), 0);
  shares[moment_.motion] = 1;
  set_.pose(shares, framePhase(set_.actor().motions()[moment_.motion], frame, moment_.count));
  if (room_) room_->setShadow(set_.surfacePose());
  if (!set_.bystander()) return;
  set_.bystander()->pose(frame / options_.fps);
  room_->setOtherShadow(set_.bystander()->positions(), set_.bystander()->faces());
}

// Backdrop of the room; empty in the green studio, whose backdrop is in the sensor.
Result<Image> Filming::behind(size_t camera) {
  if (!room_) return Image();
  if (!set_.bystander()) return room_->withShadow(camera);
  const PinholeCamera& c = set_.rig().ring[camera];
  FOURDVT_ASSIGN(const Image drawn, set_.bystander()->draw(set_.lens().drawn(c)));
  return composed(set_.lens().filmed(c, drawn), room_->withShadow(camera));
}

Result<Filming::Recorded> Filming::record(size_t camera) {
  if (options_.knobs.offset_frames != 0) pose(moment_.frame + offsets_[camera]);
  FOURDVT_ASSIGN(auto picture, set_.film(set_.rig().ring[camera]));
  FOURDVT_ASSIGN(const Image backdrop, behind(camera));
  const Sensor& sensor = sensors_[camera];
  const uint32_t filmed = filmedFrames(set_.actor().motions()[moment_.motion], options_);
  const glm::dvec3 drift = sensor.drift(moment_.motion, double(moment_.frame) / std::max(1u, filmed - 1));
  return Recorded{sensor.expose(picture, moment_.shot, room_ ? &backdrop : nullptr, drift), sensor.matte(picture)};
}

}  // namespace fourdvt::studio
