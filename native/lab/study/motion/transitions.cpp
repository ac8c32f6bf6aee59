// SPDX-License-Identifier: Apache-2.0
// Transitions of the player: the waits and fits planned by the motion graph, and the maximum change per tick beside
// that of the two motions themselves. Also the sliding of feet while the character travels.
#include <cmath>
#include <map>

#include "bake/motion/root_track.h"
#include "lab/study/motion/motion.h"
#include "lab/study/motion/player.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/tables/report.h"
#include "motion/motion_graph.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr double kLatency_s = 0.4;
constexpr int kMaxTicks = 75, kTicksAfter = 6;
constexpr int kPasses = 2;     // passes of a loop, for the skate
constexpr int kOwnPasses = 8;  // passes of a class, whose frames fall on different ticks in each pass

struct Largest {
  double step_m = 0, levels = 0;
  void add(const TickChange& change) {
    step_m = std::max(step_m, change.step_m);
    levels = std::max(levels, change.levels);
  }
  void add(const Largest& other) { add(TickChange{other.step_m, other.levels}); }
};

struct Waits {  // from the request to the first tick of the target
  int count = 0;
  double sum_s = 0, max_s = 0;
  void add(double wait_s) {
    ++count;
    sum_s += wait_s;
    max_s = std::max(max_s, wait_s);
  }
};

class TransitionPart {
 public:
  explicit TransitionPart(const MotionSubject& subject) : subject_(subject), character_(subject.stage.character()) {}
  Result<Rows> run();

 private:
  Status ownPace(const package::Sequence& state);
  Status play(const package::Sequence& state, double parameter, Largest& out);
  Status pair(size_t from, size_t to);
  void planned(size_t from, size_t to, const RowWriter& row) const;
  Status simulate(const package::Sequence& from, const package::Sequence& to, uint32_t frame, Largest& changes,
                  Waits& waits);
  std::vector<uint32_t> startFrames(const package::Sequence& state) const;

  const MotionSubject& subject_;
  const package::Character& character_;
  std::optional<motion::MotionGraph> graph_;
  std::unique_ptr<WatchedPlayer> watched_;
  std::map<std::string, Largest> own_;
  Rows out_;
};

Result<Rows> TransitionPart::run() {
  if (character_.graph_uri.empty()) return Rows();
  FOURDVT_ASSIGN(auto bytes, platform::readFile(subject_.folder + "/" + character_.graph_uri));
  FOURDVT_ASSIGN(auto graph, motion::MotionGraph::read(bytes, character_));
  graph_.emplace(std::move(graph));
  FOURDVT_ASSIGN(watched_, WatchedPlayer::open(*subject_.context.device, subject_.folder, false));
  for (const package::Sequence& state : character_.sequences) FOURDVT_TRY(ownPace(state));
  for (size_t from = 0; from < character_.sequences.size(); ++from)
    for (size_t to = 0; to < character_.sequences.size(); ++to)
      if (from != to && graph_->entry(int(from), 0, 0, int(to))) FOURDVT_TRY(pair(from, to));
  return std::move(out_);
}

Status TransitionPart::play(const package::Sequence& state, double parameter, Largest& out) {
  FOURDVT_TRY(watched_->start(state.name, 0, parameter));
  double duration_s = state.duration_s();
  for (const package::Member& member : state.members) duration_s = std::max(duration_s, member.duration_s);
  const int passes = state.isClass() && !subject_.quick() ? kOwnPasses : 1;
  const int ticks = static_cast<int>(std::ceil(passes * duration_s / kTick_s)) + (state.loop ? 2 : -1);
  for (int i = 0; i < ticks; ++i) {
    FOURDVT_TRY(checkStop(subject_.context));
    FOURDVT_ASSIGN(auto change, watched_->tick());
    out.add(change);
  }
  return {};
}

// Maximum changes of the motion by itself; for a class, at both ends of the parameter and in the middle.
Status TransitionPart::ownPace(const package::Sequence& state) {
  Largest& own = own_[state.name];
  if (!state.isClass()) return play(state, std::nan(""), own);
  const motion::Range range = motion::parameterRange(state, 0);
  for (const double share : subject_.quick() ? std::vector{0.5} : std::vector{0.0, 0.5, 1.0})
    FOURDVT_TRY(play(state, range.min + share * (range.max - range.min), own));
  return {};
}

std::vector<uint32_t> TransitionPart::startFrames(const package::Sequence& state) const {
  const uint32_t count = subject_.quick() ? 1 : 4, usable = state.loop ? state.frame_count : state.frame_count / 2;
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < count; ++i) out.push_back((2 * i + 1) * usable / (2 * count));
  return out;
}

// Waits and fits by the graph's tables, from each frame.
void TransitionPart::planned(size_t from, size_t to, const RowWriter& row) const {
  const package::Sequence& source = character_.sequences[from];
  std::vector<float> weights{1};
  double fps = source.fps;
  if (source.isClass()) {
    const double middle = WatchedPlayer::middleParameter(source);
    weights = motion::weightsAt(source, {&middle, 1}).members;
    fps = source.frame_count / motion::durationAt(source, weights);
  }
  double latency = 0, max_latency = 0, fit = 0, worst_fit = 0;
  int count = 0;
  for (uint32_t frame = 0; frame < source.frame_count; ++frame) {
    motion::PlanOptions options;
    options.max_latency_s = kLatency_s;
    const auto plan = graph_->plan({int(from), frame, weights, fps}, int(to), options);
    if (!plan) continue;
    latency += plan->wait_frames / fps;
    max_latency = std::max(max_latency, plan->wait_frames / fps);
    fit += plan->entry.cost;
    worst_fit = std::max(worst_fit, double(plan->entry.cost));
    ++count;
  }
  if (!count) return;
  row.add({{kLatencyMeanS, latency / count},
           {kLatencyMaxS, max_latency},
           {kFitMeanMm, fit / count},
           {kFitMaxMm, worst_fit}});
}

Status TransitionPart::pair(size_t from, size_t to) {
  const package::Sequence &source = character_.sequences[from], &target = character_.sequences[to];
  Largest changes, own = own_[source.name];
  own.add(own_[target.name]);
  Waits waits;
  for (const uint32_t frame : startFrames(source)) FOURDVT_TRY(simulate(source, target, frame, changes, waits));
  const RowWriter row(out_, kMotionTransitions, "", "", "from=" + source.name + " to=" + target.name);
  planned(from, to, row);
  if (!waits.count) return {};
  row.add({{kLatencyPlayedMeanS, waits.sum_s / waits.count},
           {kLatencyPlayedS, waits.max_s},
           {kStepMm, 1e3 * changes.step_m},
           {kOwnStepMm, 1e3 * own.step_m},
           {kChangeLevels, changes.levels},
           {kOwnChangeLevels, own.levels}});
  return {};
}

// Simulates from the request until shortly after the target has taken over.
Status TransitionPart::simulate(const package::Sequence& from, const package::Sequence& to, uint32_t frame,
                                Largest& changes, Waits& waits) {
  if (to.isClass())
    FOURDVT_TRY(watched_->player().setParameter(to.space.names[0], WatchedPlayer::middleParameter(to), true));
  FOURDVT_TRY(watched_->start(from.name, frame, WatchedPlayer::middleParameter(from)));
  FOURDVT_TRY(watched_->player().goTo(to.name));
  bool faded = false;
  for (int i = 0, after = 0; i < kMaxTicks && after < kTicksAfter; ++i) {
    FOURDVT_TRY(checkStop(subject_.context));
    FOURDVT_ASSIGN(auto change, watched_->tick());
    const bool fading = watched_->player().inTransition();
    if (fading && !faded) {
      faded = true;
      waits.add((i + 1) * kTick_s);
    }
    if (faded) changes.add(change);
    if (faded && !fading) ++after;
  }
  return {};
}

// Plays some passes while the character travels over the ground.
Result<bake::FootSkate> skateOf(const MotionSubject& subject, WatchedPlayer& watched, const package::Sequence& state,
                                double parameter) {
  FOURDVT_TRY(watched.start(state.name, 0, parameter));
  double duration_s = state.duration_s();
  if (state.isClass()) duration_s = motion::durationAt(state, motion::weightsAt(state, {&parameter, 1}).members);
  std::vector<Positions> shown;
  for (int i = 0; i < static_cast<int>(kPasses * duration_s / kTick_s); ++i) {
    FOURDVT_TRY(checkStop(subject.context));
    FOURDVT_TRY(watched.tick());
    shown.push_back(watched.world());
  }
  capture::Capture world;
  world.fps = 1 / kTick_s;
  capture::CaptureSequence walked;
  walked.frame_count = static_cast<uint32_t>(shown.size());
  const std::vector<glm::vec3> no_track(shown.size() + 1, glm::vec3(0));  // travel is already in the positions
  return bake::footSkate(world, walked, no_track,
                         [&](const capture::CaptureSequence&, uint32_t t) -> Result<Positions> { return shown[t]; });
}

void writeSkate(const bake::FootSkate& skate, const RowWriter& row) {
  row.add({{kContacts, skate.contacts},
           {kSkateMeanMm, 1e3 * skate.mean_m},
           {kSkateTailMm, 1e3 * skate.tail_m},
           {kSkateMaxMm, 1e3 * skate.max_m}});
}

}  // namespace

Result<Rows> measureTransitions(const MotionSubject& subject) { return TransitionPart(subject).run(); }

Result<Rows> measureSkate(const MotionSubject& subject) {
  FOURDVT_ASSIGN(auto watched, WatchedPlayer::open(*subject.context.device, subject.folder, true));
  Rows out;
  const package::Sequence& motion = subject.motion();
  const motion::Range range = motion::parameterRange(motion, 0);
  const int speeds = subject.quick() ? 2 : 5;
  for (int i = 0; i < speeds; ++i) {
    const double parameter = range.min + (range.max - range.min) * i / (speeds - 1);
    FOURDVT_ASSIGN(auto skate, skateOf(subject, *watched, motion, parameter));
    writeSkate(skate, RowWriter(out, kMotionSkate, motion.name, "", "at=" + fixedText(parameter, 2)));
  }
  for (const package::Member& member : motion.members) {
    const package::Sequence* state = subject.stage.character().find(member.name);
    if (!state || !state->loop || subject.quick()) continue;
    FOURDVT_ASSIGN(auto skate, skateOf(subject, *watched, *state, std::nan("")));
    writeSkate(skate, RowWriter(out, kMotionSkate, state->name, "", ""));
  }
  return out;
}

}  // namespace fourdvt::study
