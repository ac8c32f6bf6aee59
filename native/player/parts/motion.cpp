// SPDX-License-Identifier: Apache-2.0
#include "player/parts/motion.h"

#include <algorithm>
#include <cmath>

#include "motion/blend.h"

namespace fourdvt {
double Parameters::wanted(const package::Sequence& sequence, size_t parameter) const {
  const motion::Range range = motion::parameterRange(sequence, parameter);
  const auto set = wanted_.find(sequence.space.names[parameter]);
  const std::vector<double>& first = sequence.members[0].parameter;
  const double value = set != wanted_.end() ? set->second : parameter < first.size() ? first[parameter] : range.min;
  return std::clamp(value, range.min, range.max);
}

std::vector<double> parametersAt(const package::Sequence& sequence, const std::vector<float>& weights) {
  const package::ParameterSample* nearest = nullptr;
  float min_distance = 1e30f;
  for (const package::ParameterSample& sample : sequence.space.samples) {
    float distance = 0;
    for (size_t m = 0; m < weights.size(); ++m) distance += std::abs(weights[m] - sample.weights[m]);
    if (distance >= min_distance) continue;
    min_distance = distance;
    nearest = &sample;
  }
  return nearest ? nearest->at : std::vector<double>{};
}

void ShownParameters::enter(const package::Sequence& sequence, const Parameters& parameters) {
  values_ = std::move(entry_);
  entry_.clear();
  for (size_t p = values_.size(); p < sequence.space.names.size(); ++p)
    values_.push_back(parameters.wanted(sequence, p));
  weights_ = motion::weightsAt(sequence, values_);
}

bool ShownParameters::glide(const package::Sequence& sequence, const Parameters& parameters, double dt_s) {
  bool moved = false;
  for (size_t p = 0; p < values_.size(); ++p) {
    const motion::Range range = motion::parameterRange(sequence, p);
    const double max_step = (range.max - range.min) * parameters.rate() * dt_s;
    const double step = std::clamp(parameters.wanted(sequence, p) - values_[p], -max_step, max_step);
    values_[p] += step;
    moved |= step != 0;
  }
  if (moved) weights_ = motion::weightsAt(sequence, values_);
  return moved;
}

namespace {

constexpr double kMaxLatency_s = 0.4;  // from the request to the start of the fade, if the target is prepared in time
constexpr double kReturnChoice_s = 0.12;  // slack for a good exit before the end of a state that does not loop
constexpr double kPatience_s = 5;         // timeout for a decoder without output; the target is then selected by a cut
constexpr double kMinLead_s = 0.05, kMaxLead_s = 2;

}  // namespace

bool Transitions::ask(int goal, double now_s) {
  if (goal != goal_) asked_s_ = now_s;
  if (fading()) goal_ = goal;
  return fading();
}

void Transitions::askReturn(double now_s) {
  asked_s_ = now_s;
  goal_ = return_to_;
}

void Transitions::begin(int target, double now_s) {
  run_ = {};
  run_.phase = Phase::Wanted;
  run_.target = target;
  run_.patient_since_s = now_s;
}

Transitions::Step Transitions::step(const TransitionView& view) {
  if (view.held) asked_s_ = view.now_s;
  // No timeout while the network is behind: the source plays on.
  if (view.held || !(view.target_fetched || view.target_prepared)) run_.patient_since_s = view.now_s;
  if (view.held || (run_.phase != Phase::Wanted && run_.phase != Phase::Preparing)) return Step::Nothing;
  if (view.graph_failed || view.now_s - run_.patient_since_s > kPatience_s) return Step::Select;
  if (!view.graph || !view.target_has_header) return Step::Nothing;
  if (run_.phase == Phase::Wanted) return Step::Plan;
  if (view.target_prepared && !run_.measured) {
    run_.measured = true;
    lead_s_ = std::clamp(1.25 * (view.now_s - run_.prepared_since_s), kMinLead_s, kMaxLead_s);
  }
  const bool at_end = !view.loops && view.frame() + 1 == view.sequence->frame_count;
  if (view.k < run_.begin_k && !at_end) return Step::Nothing;
  if (view.target_prepared) return Step::StartFade;
  if (!at_end && view.k <= run_.begin_k + 1) return Step::Nothing;
  lead_s_ = std::min(2 * lead_s_, kMaxLead_s);  // target too late
  return Step::Plan;
}

std::optional<Transitions::Entrance> Transitions::plan(const TransitionView& view, const package::Sequence& to,
                                                       bool to_loops) {
  const double rate = view.sequence->fps * view.clock_rate;
  // Age of the shown frame.
  const double age_s = view.clock_s / view.clock_rate - static_cast<double>(view.k) / rate;
  motion::PlanOptions options;
  options.min_wait_s = lead_s_ + age_s;
  // Reserves one tick: a frame is displayed at the first tick after it is due.
  options.max_latency_s = kMaxLatency_s - (view.now_s - asked_s_) - view.tick_s + age_s;
  const auto way = view.graph->plan({view.source, view.frame(), view.weights, rate}, run_.target, options);
  if (!way) return std::nullopt;
  const motion::Entry& entry = way->entry;
  run_.fade_frames = to_loops ? entry.fade_frames : std::clamp(to.frame_count - 1 - entry.frame, 1u, entry.fade_frames);
  run_.shift = entry.shift;
  run_.begin_k = view.k + way->wait_frames;
  const bool anew = run_.phase != Phase::Preparing || run_.entry_k != entry.frame;
  run_.phase = Phase::Preparing;
  run_.entry_k = entry.frame;
  if (anew) {
    run_.prepared_since_s = view.now_s;
    run_.measured = false;
  }
  const motion::GraphState& state = view.graph->states()[static_cast<size_t>(run_.target)];
  return Entrance{run_.entry_k, &state.weight_rows[entry.weight_row], anew};
}

bool Transitions::stepFade(double target_frames, bool new_picture) {
  const double passed = target_frames - static_cast<double>(run_.entry_k);
  if (!new_picture && passed < run_.fade_frames) return false;
  const float fade = motion::fadeWeight(passed, run_.fade_frames);
  if (fade == run_.fade) return false;
  run_.fade = fade;
  return true;
}

void Transitions::finish(int left, bool left_loops, bool entered_loops) {
  if (entered_loops)
    return_to_ = -1;
  else if (left_loops)
    return_to_ = left;
  run_ = {};
}

void Transitions::cancel(int current) {
  run_ = {};
  goal_ = current;
}

bool Transitions::returnDue(const TransitionView& view, const package::Sequence& to) const {
  const double rate = view.sequence->fps * view.clock_rate;
  const uint32_t frame = view.frame();
  const motion::Entry* entry = view.graph ? view.graph->entry(view.source, frame, 0, return_to_) : nullptr;
  double needed = 0;  // in source frames
  if (entry) {
    const motion::GraphState& state = view.graph->states()[static_cast<size_t>(return_to_)];
    const double pass_s = motion::durationAt(to, state.weight_rows[entry->weight_row]);
    needed = (lead_s_ + kReturnChoice_s + entry->fade_frames * pass_s / to.frame_count) * rate;
  }
  return view.sequence->frame_count - 1 - frame <= needed;
}

void RootMotion::place(const motion::Placement& placement) {
  if (!std::isfinite(placement.ground_m.x + placement.ground_m.y + placement.heading_rad)) return;
  placement_ = placement;
  wanted_heading_rad_.reset();
}

void RootMotion::steer(double heading_rad) {
  if (std::isfinite(heading_rad)) wanted_heading_rad_ = heading_rad;
}

void RootMotion::turn(double dt_s) {
  if (!wanted_heading_rad_) return;
  const float max_turn = static_cast<float>(turn_rate_rad_s_ * dt_s);
  const float left = motion::wrapAngle(static_cast<float>(*wanted_heading_rad_) - placement_.heading_rad);
  placement_.heading_rad = motion::wrapAngle(placement_.heading_rad + std::clamp(left, -max_turn, max_turn));
}

motion::Placement RootMotion::sourcePlacement() const {
  if (!fading_) return placement_;
  return motion::moved(placement_, motion::stepBetween(fade_ * shift_, glm::vec3(0)));
}

void RootMotion::setSourcePlacement(const motion::Placement& placement) {
  placement_ = motion::moved(placement, fade_ * shift_);
}

void RootMotion::move(const glm::vec3& step, Side side) {
  if (!travel_) return;
  if (!fading_) {
    placement_ = motion::moved(placement_, step);
    return;
  }
  motion::Placement source = sourcePlacement();
  if (side == Side::Source) {
    source = motion::moved(source, (1 - fade_) * step);
  } else {
    const motion::Placement target = motion::moved(source, shift_);
    source = motion::moved(motion::moved(target, fade_ * step), motion::stepBetween(shift_, glm::vec3(0)));
  }
  setSourcePlacement(source);
}

void RootMotion::beginFade(const glm::vec3& shift) {
  fading_ = true;
  shift_ = shift;
  fade_ = 0;
}

void RootMotion::setFade(float fade) {
  const motion::Placement source = sourcePlacement();
  fade_ = fade;
  if (travel_) setSourcePlacement(source);
}

void RootMotion::cancelFade() {
  if (travel_) placement_ = sourcePlacement();
  fading_ = false;
}

void RootTrail::lead(RootMotion& motion, RootMotion::Side side, const RootFrame& to, int64_t passes) const {
  glm::vec3 from(0), pass(0);
  for (size_t m = 0; m < to.weights.size(); ++m) {
    from += to.weights[m] * roots_[m];
    pass += to.weights[m] * glm::vec3(to.sequence.members[m].travel);
  }
  for (; passes > 0; --passes) {
    motion.move(motion::stepBetween(from, pass), side);
    from = glm::vec3(0);
  }
  motion.move(motion::stepBetween(from, motion::rootOf(*to.geometry.frames, to.geometry.row, to.weights)), side);
}

void RootTrail::keep(const RootFrame& frame) {
  const size_t members = frame.sequence.members.size();
  for (size_t m = 0; m < members; ++m) roots_[m] = frame.geometry.frames->root[frame.geometry.row * members + m];
}

}  // namespace fourdvt
