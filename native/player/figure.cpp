// SPDX-License-Identifier: Apache-2.0
// What is drawn: picture, labels, alignment and mesh of the shown presentations.
#include <algorithm>

#include "motion/mesh_blend.h"
#include "player/player_impl.h"

namespace fourdvt {

// Picture, labels and alignment of one presentation go on screen together; its mesh follows in composeMesh. False: no
// memory for it.
bool PlayerImpl::present(Track& t, int slot_index) {
  Slot& slot = t.slots[static_cast<size_t>(slot_index)];
  const package::Sequence& sequence = wantedOf(t);
  const uint32_t frame = frameOf(t, slot.k);
  const package::ChunkFrames& frames = *geometryOf(slot.sequence, frame);
  const package::StreamIndex& index = stateOf(t).index;
  const uint32_t row = frame - index.chunks[index.chunkOfFrame(frame)].first_frame;
  const int members = static_cast<int>(sequence.members.size());
  if (!t.appearance || t.appearance->member_count != members) {
    auto made = render::Appearance::create(device_, *model_, members);
    if (!made.ok()) {
      if (&t == &main())
        fail(made.error(), -1);
      else
        selectInstead();
      return false;
    }
    t.appearance = made.take();
  }
  const size_t labels = static_cast<size_t>(frames.member_count) * frames.layer_count * frames.face_count;
  motion::alignmentOf(frames, row, index, alignment_);
  t.appearance->setFrame(device_, *model_, {std::span(frames.labels).subspan(row * labels, labels), alignment_});
  t.appearance->setLayout(sequence.renditions[0]);
  t.appearance->detail_correlation = sequence.detail_correlation;
  if (t.shown.sequence != slot.sequence || !t.entry_at.empty()) enterParameters(t, slot.sequence);
  takeRoots(t, frames, row, slot.k, !t.seeking);
  if (t.shown.slot >= 0) t.slots[static_cast<size_t>(t.shown.slot)].state = Slot::State::Free;
  t.shown = {slot_index, slot.sequence, slot.k};
  for (Slot& s : t.slots)  // overtaken pictures
    if (s.state == Slot::State::Ready && s.k < slot.k) s.state = Slot::State::Free;
  t.stale = true;
  ++stats_.frames_shown;
  return true;
}

// The shown frame's mesh at the present weights; false while its geometry is not at hand.
bool PlayerImpl::blend(Track& t) {
  const auto frame = static_cast<uint32_t>(t.shown.k % sequenceAt(t.shown.sequence).frame_count);
  const package::ChunkFrames* frames = geometryOf(t.shown.sequence, frame);
  if (!frames) return false;
  const package::StreamIndex& index = sequences_[static_cast<size_t>(t.shown.sequence)].index;
  const uint32_t row = frame - index.chunks[index.chunkOfFrame(frame)].first_frame;
  motion::blendFrame(*frames, row, index, t.weights, t.positions);
  t.stale = false;
  return true;
}

void PlayerImpl::composeMesh() {
  const bool fading = transition_.phase == Phase::Fading;
  for (Track* t : {&main(), &other()}) {
    if (t->shown.slot < 0 || !t->stale || (t != &main() && !fading)) continue;
    compose_ |= blend(*t);
  }
  if (!compose_ || main().shown.slot < 0) return;
  compose_ = false;
  if (!fading) {
    model_->setPositions(device_, main().positions);
    return;
  }
  faded_ = main().positions;
  const glm::mat4 source_from_target = motion::worldFromCharacter(motion::moved({}, transition_.shift));
  motion::crossFade(faded_, other().positions, source_from_target, transition_.fade);
  model_->setPositions(device_, faded_);
}

Result<render::Figure> PlayerImpl::figure() const {
  if (!hasFrame()) return Error{ErrorId::InvalidArgument, "nothing to draw yet: wait for canplay"};
  const bool fading = transition_.phase == Phase::Fading;
  size_t count = 0;
  for (const Track* t : {&main(), &other()}) {
    if (t != &main() && !fading) break;
    looks_[count++] = {&*t->appearance, &t->slots[static_cast<size_t>(t->shown.slot)].picture, t->weights.members};
  }
  render::Figure figure;
  figure.model = &*model_;
  figure.looks = std::span<const render::Look>(looks_.data(), count);
  figure.fade = fading ? transition_.fade : 0;
  figure.world_from_character = motion::worldFromCharacter(sourcePlacement());
  return figure;
}

Status PlayerImpl::draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target) {
  auto drawn = figure();
  if (!drawn.ok()) return drawn.error();
  return recipe_->draw({&drawn.value(), 1}, nullptr, view, {options, align_}, target);
}

}  // namespace fourdvt
