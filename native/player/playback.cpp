// SPDX-License-Identifier: Apache-2.0
// Clock, commands, the choice of the picture to show.
#include <algorithm>
#include <cmath>

#include "player/player_impl.h"

namespace fourdvt {

namespace {
constexpr double kStarvedBeforeWaiting_s = 0.25;
constexpr double kTimeUpdatePeriod_s = 0.25;
}  // namespace

Result<std::unique_ptr<Player>> Player::create(gpu::Device& device, const PlayerOptions& options) {
  if (options.picture_slots < 2) return Error{ErrorId::InvalidArgument, "picture_slots must be at least 2"};
  auto recipe = render::Recipe::create(device);
  if (!recipe.ok()) return recipe.error();
  return std::unique_ptr<Player>(new PlayerImpl(device, options, recipe.take()));
}

PlayerImpl::PlayerImpl(gpu::Device& device, const PlayerOptions& options, std::unique_ptr<render::Recipe> recipe)
    : device_(device), options_(options), recipe_(std::move(recipe)), cache_(options.encoded_budget_bytes) {
  slots_.resize(static_cast<size_t>(options.picture_slots));
}

bool PlayerImpl::looping() const { return loop_override_ < 0 ? active().loop : loop_override_ == 1; }

uint32_t PlayerImpl::frameOf(int64_t k) const { return static_cast<uint32_t>(k % frameCount()); }

void PlayerImpl::startAt(uint32_t frame) {
  wanted_k_ = frame;
  seeking_ = true;
  ended_ = false;
  starved_since_s_ = -1;
  clock_.jump(frame / fps());
  clock_.setRunning(false);
  stopFeed();
  const SequenceState& state = sequences_[static_cast<size_t>(active_)];
  if (state.header == stream::PartState::Present && !state.broken) restartFeed();
  requestMissing();
}

void PlayerImpl::play() {
  if (playing_) return;
  playing_ = true;
  if (active_ < 0) return;
  if (ended_) startAt(0);
  clock_.setRunning(!seeking_);
  if (!seeking_) emit(EventKind::Playing);
}

void PlayerImpl::pause() {
  if (!playing_) return;
  playing_ = waiting_ = false;
  clock_.setRunning(false);
  if (!seeking_ && shown_.slot >= 0) wanted_k_ = shown_.k;
  emit(EventKind::Paused);
}

void PlayerImpl::seekFrame(uint32_t frame) {
  if (active_ < 0) return;
  seek_requested_ = true;
  startAt(std::min(frame, frameCount() - 1));
}

void PlayerImpl::seek(double time_s) {
  if (active_ < 0 || !std::isfinite(time_s)) return;
  seekFrame(static_cast<uint32_t>(std::clamp(time_s * fps() + 1e-6, 0.0, static_cast<double>(frameCount() - 1))));
}

Status PlayerImpl::selectSequence(const std::string& name) {
  wanted_name_ = name;
  if (!character_) return {};
  for (size_t i = 0; i < character_->sequences.size(); ++i) {
    if (character_->sequences[i].name != name) continue;
    if (static_cast<int>(i) == active_) return {};
    active_ = static_cast<int>(i);
    startAt(0);
    return {};
  }
  return Error{ErrorId::InvalidArgument, "the character has no sequence named " + name};
}

void PlayerImpl::setRate(double rate) {
  if (rate > 0) clock_.setRate(std::min(rate, 4.0));
}

void PlayerImpl::setLoop(int loop) {
  loop_override_ = std::clamp(loop, -1, 1);
  if (active_ >= 0 && ready() && feeding_ && feed_done_ && looping() && shown_.slot >= 0 && !seeking_) {
    wanted_k_ = shown_.k;
    restartFeed();
    seeking_ = true;
    clock_.setRunning(false);
  }
}

void PlayerImpl::tick(double now_s) {
  now_s_ = now_s;
  clock_.advance(now_s);
  if (active_ < 0) return;
  requestMissing();
  if (ready()) choosePicture();
  if (playing_ && !seeking_ && now_s - last_timeupdate_s_ >= kTimeUpdatePeriod_s) {
    last_timeupdate_s_ = now_s;
    emit(EventKind::TimeUpdate);
  }
}

// The newest ready picture up to `newest_k` that is newer than the shown one; while seeking only the wanted one.
int PlayerImpl::pictureFor(int64_t newest_k) const {
  int best = -1;
  for (size_t i = 0; i < slots_.size(); ++i) {
    const Slot& slot = slots_[i];
    if (slot.state != Slot::State::Ready || slot.epoch != epoch_ || static_cast<int>(i) == shown_.slot) continue;
    const bool fits = seeking_ ? slot.k == wanted_k_ : slot.k <= newest_k && slot.k > shown_.k;
    if (fits && (best < 0 || slot.k > slots_[static_cast<size_t>(best)].k)) best = static_cast<int>(i);
  }
  return best;
}

void PlayerImpl::choosePicture() {
  if (!seeking_ && !playing_) return;
  const auto clock_k = static_cast<int64_t>(std::floor(clock_.position() * fps() + 1e-6));
  const int slot = pictureFor(clock_k);
  if (slot >= 0 && geometryOf(active_, frameOf(slots_[static_cast<size_t>(slot)].k))) {
    const int previous_sequence = shown_.sequence;
    if (!seeking_) stats_.frames_late += static_cast<uint64_t>(slots_[static_cast<size_t>(slot)].k - shown_.k - 1);
    present(slot);
    noteStarvation(false);
    if (seeking_) finishSeek(previous_sequence);
  } else if (playing_ && !seeking_) {
    noteStarvation(clock_k > shown_.k && !feed_done_);
  }
  if (!playing_ || seeking_) return;
  int64_t newest_k = shown_.k;
  for (const Slot& s : slots_)
    if (s.state == Slot::State::Ready && s.epoch == epoch_) newest_k = std::max(newest_k, s.k);
  clock_.holdAt(static_cast<double>(newest_k + 1) / fps());
  const bool at_end = !looping() && frameOf(shown_.k) + 1 == frameCount();
  if (at_end && clock_.position() * fps() >= static_cast<double>(shown_.k + 1) - 1e-6) {
    playing_ = false;
    ended_ = true;
    wanted_k_ = shown_.k;
    clock_.setRunning(false);
    emit(EventKind::Ended);
  }
}

void PlayerImpl::finishSeek(int previous_sequence) {
  seeking_ = false;
  clock_.jump(static_cast<double>(shown_.k) / fps());
  clock_.setRunning(playing_);
  if (!can_play_) {
    can_play_ = true;
    emit(EventKind::CanPlay);
  }
  if (previous_sequence >= 0 && previous_sequence != shown_.sequence) emit(EventKind::SequenceChanged);
  if (seek_requested_) emit(EventKind::Seeked);
  seek_requested_ = false;
  if (playing_) emit(EventKind::Playing);
}

void PlayerImpl::noteStarvation(bool starved) {
  if (!starved) {
    starved_since_s_ = -1;
    if (waiting_ && playing_) emit(EventKind::Playing);
    waiting_ = false;
    return;
  }
  if (starved_since_s_ < 0) starved_since_s_ = now_s_;
  if (!waiting_ && now_s_ - starved_since_s_ > kStarvedBeforeWaiting_s) {
    waiting_ = true;
    emit(EventKind::Waiting);
  }
}

// Picture, positions and labels of one presentation go on screen together.
void PlayerImpl::present(int slot_index) {
  Slot& slot = slots_[static_cast<size_t>(slot_index)];
  const uint32_t frame = frameOf(slot.k);
  const package::ChunkFrames* geometry = geometryOf(slot.sequence, frame);
  const package::StreamIndex& index = sequences_[static_cast<size_t>(slot.sequence)].index;
  const size_t row = frame - index.chunks[index.chunkOfFrame(frame)].first_frame;
  positions_.resize(geometry->vertex_count);
  for (size_t v = 0; v < positions_.size(); ++v)
    positions_[v] = index.position_origin +
                    index.position_step_m * glm::vec3(geometry->positions[row * geometry->vertex_count + v]);
  const size_t label_count = static_cast<size_t>(geometry->layer_count) * geometry->face_count;
  model_->setGeometry(device_, {positions_, std::span(geometry->labels).subspan(row * label_count, label_count)});
  model_->setLayout(active().renditions[0]);
  if (shown_.slot >= 0) slots_[static_cast<size_t>(shown_.slot)].state = Slot::State::Free;
  shown_ = {slot_index, slot.sequence, slot.k};
  for (size_t i = 0; i < slots_.size(); ++i)  // overtaken pictures
    if (slots_[i].state == Slot::State::Ready && slots_[i].k < slot.k) slots_[i].state = Slot::State::Free;
  ++stats_.frames_shown;
}

Status PlayerImpl::draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target) {
  if (shown_.slot < 0) return Error{ErrorId::InvalidArgument, "nothing to draw yet: wait for canplay"};
  return recipe_->draw(*model_, slots_[static_cast<size_t>(shown_.slot)].picture, view, options, target);
}

const package::Sequence* PlayerImpl::sequence() const { return active_ >= 0 ? &active() : nullptr; }

uint32_t PlayerImpl::frame() const {
  if (active_ < 0) return 0;
  if (shown_.slot < 0) return frameOf(wanted_k_);
  return static_cast<uint32_t>(shown_.k % character_->sequences[static_cast<size_t>(shown_.sequence)].frame_count);
}

double PlayerImpl::currentTime() const {
  if (active_ < 0) return 0;
  return frameOf(seeking_ || shown_.slot < 0 ? wanted_k_ : shown_.k) / fps();
}

PlayerStats PlayerImpl::stats() const {
  PlayerStats stats = stats_;
  stats.encoded_bytes_held = cache_.encodedBytes();
  return stats;
}

bool PlayerImpl::nextEvent(Event& out) {
  if (events_.empty()) return false;
  out = std::move(events_.front());
  events_.pop_front();
  return true;
}

}  // namespace fourdvt
