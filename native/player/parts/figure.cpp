// SPDX-License-Identifier: Apache-2.0
#include "player/parts/figure.h"

#include <algorithm>

#include "base/later.h"
#include "motion/blend.h"
#include "motion/placement.h"

namespace fourdvt {
namespace {

uint64_t nextSerial() {
  static uint64_t serial = 0;
  return ++serial;
}

glm::vec4 vec4Of(const package::Rect& r) { return {r.x, r.y, r.width, r.height}; }

}  // namespace

void SurfaceFrame::place(const package::Character& character, const package::Sequence& sequence,
                         const package::Rendition& rendition, const package::SurfaceChunk& chunk) {
  const package::Rect& area = rendition.tiles;
  const glm::vec2 size(rendition.width, rendition.height);
  const glm::vec2 scale(float(area.width) / sequence.layout_width, float(area.height) / sequence.layout_height);
  sources.clear();
  for (const package::CameraTile& tile : chunk.tiles()) {
    const glm::vec4 place = vec4Of(tile.tile) * glm::vec4(scale, scale) + glm::vec4(area.x, area.y, 0, 0);
    sources.push_back({vec4Of(tile.source), place / glm::vec4(size, size)});
  }
  look = {character.cameras, sources, nullptr, size, nextSerial()};
}

void SurfaceFrame::take(const FrameGeometry& geometry, Positions& positions) {
  const package::Surface surface = geometry.surfaces->surface(geometry.row);
  const bool as_many = positions.size() == surface.positions.size();
  positions.assign(surface.positions.begin(), surface.positions.end());
  if (as_many && std::equal(faces.begin(), faces.end(), surface.faces.begin(), surface.faces.end())) return;
  faces.assign(surface.faces.begin(), surface.faces.end());
  topology_serial = nextSerial();
}

Status ShownFrame::present(gpu::Device& device, const render::CharacterModel& model,
                           const package::Character& character, const package::Sequence& sequence,
                           const package::Rendition& rendition, const FrameGeometry& geometry) {
  if (geometry.surfaces) {
    later<&SurfaceFrame::place>(surface_, character, sequence, rendition, *geometry.surfaces);
    stale_ = true;
    return {};
  }
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
  appearance_->setLayout(rendition);
  appearance_->detail_correlation = sequence.detail_correlation;
  stale_ = true;
  return {};
}

void ShownFrame::blend(const FrameGeometry& geometry, const motion::BlendWeights& weights) {
  if (geometry.surfaces)
    later<&SurfaceFrame::take>(surface_, geometry, positions_);
  else
    motion::blendFrame(*geometry.frames, geometry.row, *geometry.index, weights, positions_);
  stale_ = false;
}

Status FigureComposer::setMesh(gpu::Device& device, const package::Character& character,
                               const package::BaseMesh& mesh) {
  auto model = render::CharacterModel::create(device, character, mesh);
  if (!model.ok()) return model.error();
  model_ = model.take();
  return {};
}

void FigureComposer::compose(gpu::Device& device, const ShownFrame& first, const ShownFrame* second,
                             const MeshFade& fade) {
  if (!stale_) return;
  stale_ = false;
  if (first.surface().topology_serial != topology_serial_) {
    topology_serial_ = first.surface().topology_serial;
    // Within the manifest's counts: checked by the surface reader.
    (void)later<&render::CharacterModel::setTopology>(*model_, device, first.surface().faces,
                                                      static_cast<uint32_t>(first.positions().size()));
  }
  if (!second) {
    model_->setPositions(device, first.positions());
    return;
  }
  faded_ = first.positions();
  const glm::mat4 first_from_second = motion::worldFromCharacter(motion::moved({}, fade.shift));
  motion::crossFade(faded_, second->positions(), first_from_second, fade.share);
  model_->setPositions(device, faded_);
}

render::Figure FigureComposer::cameraFigure(const ShownFrame& frame, const render::PictureTextures& picture,
                                            const glm::mat4& world_from_character) const {
  camera_look_ = frame.surface().look;
  camera_look_.picture = &picture;
  render::Figure figure;
  figure.model = &*model_;
  figure.cameras = &camera_look_;
  figure.world_from_character = world_from_character;
  return figure;
}

render::Figure FigureComposer::figure(std::span<const render::Look> looks, float fade,
                                      const glm::mat4& world_from_character) const {
  std::copy(looks.begin(), looks.end(), looks_.begin());
  render::Figure figure;
  figure.model = &*model_;
  figure.looks = std::span<const render::Look>(looks_.data(), looks.size());
  figure.fade = fade;
  figure.world_from_character = world_from_character;
  return figure;
}

}  // namespace fourdvt
