// SPDX-License-Identifier: Apache-2.0
#include "player/parts/shown_frame.h"

#include "motion/mesh_blend.h"

namespace fourdvt {

Status ShownFrame::present(gpu::Device& device, const render::CharacterModel& model, const package::Sequence& sequence,
                           const FrameGeometry& geometry) {
  const int members = static_cast<int>(sequence.members.size());
  if (!appearance_ || appearance_->member_count != members) {
    auto made = render::Appearance::create(device, model, members);
    if (!made.ok()) return made.error();
    appearance_ = made.take();
  }
  const package::ChunkFrames& frames = *geometry.frames;
  const size_t labels = static_cast<size_t>(frames.member_count) * frames.layer_count * frames.face_count;
  motion::alignmentOf(frames, geometry.row, *geometry.index, alignment_);
  appearance_->setFrame(device, model, {std::span(frames.labels).subspan(geometry.row * labels, labels), alignment_});
  appearance_->setLayout(sequence.renditions[0]);
  appearance_->detail_correlation = sequence.detail_correlation;
  stale_ = true;
  return {};
}

void ShownFrame::blend(const FrameGeometry& geometry, const motion::BlendWeights& weights) {
  motion::blendFrame(*geometry.frames, geometry.row, *geometry.index, weights, positions_);
  stale_ = false;
}

}  // namespace fourdvt
