// SPDX-License-Identifier: Apache-2.0
// Parameters of classes and root motion.
#include <algorithm>
#include <cmath>

#include "motion/mesh_blend.h"
#include "player/player_impl.h"

namespace fourdvt {

// A class's phases pass as fast as the pass takes at these weights.
double PlayerImpl::clockRate(const Track& t) const {
  if (!t.used() || t.shown.sequence != t.sequence) return rate_;
  const package::Sequence& sequence = wantedOf(t);
  const double duration_s = motion::durationAt(sequence, t.weights.members);
  return sequence.isClass() && duration_s > 0 ? rate_ * sequence.duration_s() / duration_s : rate_;
}

double PlayerImpl::wantedParameter(int sequence_index, size_t parameter) const {
  const package::Sequence& sequence = sequenceAt(sequence_index);
  const motion::Range range = motion::parameterRange(sequence, parameter);
  const auto wanted = parameters_.find(sequence.space.names[parameter]);
  const std::vector<double>& first = sequence.members[0].parameter;
  const double value = wanted != parameters_.end() ? wanted->second
                       : parameter < first.size()  ? first[parameter]
                                                   : range.min;
  return std::clamp(value, range.min, range.max);
}

void PlayerImpl::enterParameters(Track& t, int sequence) {
  t.at = std::move(t.entry_at);
  t.entry_at.clear();
  for (size_t p = t.at.size(); p < sequenceAt(sequence).space.names.size(); ++p)
    t.at.push_back(wantedParameter(sequence, p));
  t.weights = motion::weightsAt(sequenceAt(sequence), t.at);
}

Status PlayerImpl::setParameter(const std::string& name, double value, bool at_once) {
  if (!std::isfinite(value)) return Error{ErrorId::InvalidArgument, name + " must be a number"};
  if (character_ && std::none_of(character_->sequences.begin(), character_->sequences.end(),
                                 [&](const auto& s) { return motion::findParameter(s, name) >= 0; }))
    return Error{ErrorId::InvalidArgument, "the character has no parameter named " + name};
  parameters_[name] = value;
  if (at_once) glideParameters(1e9);
  return {};
}

double PlayerImpl::parameter(const std::string& name) const {
  if (!character_) return std::nan("");
  if (main().shown.slot >= 0) {
    const int p = motion::findParameter(sequenceAt(main().shown.sequence), name);
    if (p >= 0) return main().at[static_cast<size_t>(p)];
  }
  for (size_t i = 0; i < sequences_.size(); ++i) {
    const int p = motion::findParameter(sequenceAt(static_cast<int>(i)), name);
    if (p >= 0) return wantedParameter(static_cast<int>(i), static_cast<size_t>(p));
  }
  return std::nan("");
}

void PlayerImpl::glideParameters(double dt_s) {
  for (Track& t : tracks_) {
    if (t.shown.slot < 0 || (&t != &main() && transition_.phase != Phase::Fading)) continue;
    const package::Sequence& sequence = sequenceAt(t.shown.sequence);
    bool moved = false;
    for (size_t p = 0; p < t.at.size(); ++p) {
      const motion::Range range = motion::parameterRange(sequence, p);
      const double most = (range.max - range.min) * options_.parameter_rate * dt_s;
      const double step = std::clamp(wantedParameter(t.shown.sequence, p) - t.at[p], -most, most);
      t.at[p] += step;
      moved |= step != 0;
    }
    if (!moved) continue;
    t.weights = motion::weightsAt(sequence, t.at);
    t.stale = true;
  }
}

void PlayerImpl::setPlacement(const motion::Placement& placement) {
  if (!std::isfinite(placement.ground_m.x + placement.ground_m.y + placement.heading_rad)) return;
  placement_ = placement;
  wanted_heading_rad_.reset();
}

void PlayerImpl::steer(double heading_rad) {
  if (std::isfinite(heading_rad)) wanted_heading_rad_ = heading_rad;
}

void PlayerImpl::turn(double dt_s) {
  if (!wanted_heading_rad_ || !playing_ || main().seeking) return;
  const float most = static_cast<float>(options_.turn_rate_rad_s * dt_s);
  const float left = motion::wrapAngle(static_cast<float>(*wanted_heading_rad_) - placement_.heading_rad);
  placement_.heading_rad = motion::wrapAngle(placement_.heading_rad + std::clamp(left, -most, most));
}

// Remembers the root values of the frame that is about to be shown; `follows`: it continues the motion of the shown
// one, so the character moves along.
void PlayerImpl::takeRoots(Track& t, const package::ChunkFrames& frames, uint32_t row, int64_t k, bool follows) {
  const package::Sequence& sequence = wantedOf(t);
  const auto mixed = [&](const auto& of) {
    glm::vec3 sum(0);
    for (size_t m = 0; m < t.weights.members.size(); ++m) sum += t.weights.members[m] * of(m);
    return sum;
  };
  const glm::vec3 pass = mixed([&](size_t m) { return glm::vec3(sequence.members[m].travel); });
  const glm::vec3 to = motion::rootOf(frames, row, t.weights.members);
  if (follows) {
    glm::vec3 from = mixed([&](size_t m) { return t.roots[m]; });
    const int64_t count = sequence.frame_count;
    for (int64_t loops = k / count - t.shown.k / count; loops > 0; --loops) {
      travel(t, motion::stepBetween(from, pass));
      from = glm::vec3(0);
    }
    travel(t, motion::stepBetween(from, to));
  }
  for (size_t m = 0; m < sequence.members.size(); ++m) t.roots[m] = frames.root[row * sequence.members.size() + m];
}

// During a fade both tracks' steps move the character, each by its share. `placement_` goes over from the source's
// place to the target's along the shift between them, so that it does not jump.
motion::Placement PlayerImpl::sourcePlacement() const {
  if (transition_.phase != Phase::Fading) return placement_;
  return motion::moved(placement_, motion::stepBetween(transition_.fade * transition_.shift, glm::vec3(0)));
}

void PlayerImpl::setSourcePlacement(const motion::Placement& placement) {
  placement_ = motion::moved(placement, transition_.fade * transition_.shift);
}

void PlayerImpl::travel(const Track& t, const glm::vec3& step) {
  if (!travel_) return;
  if (transition_.phase != Phase::Fading) {
    placement_ = motion::moved(placement_, step);
    return;
  }
  motion::Placement source = sourcePlacement();
  if (&t == &main()) {
    source = motion::moved(source, (1 - transition_.fade) * step);
  } else {
    const motion::Placement target = motion::moved(source, transition_.shift);
    source = motion::moved(motion::moved(target, transition_.fade * step),
                           motion::stepBetween(transition_.shift, glm::vec3(0)));
  }
  setSourcePlacement(source);
}

}  // namespace fourdvt
