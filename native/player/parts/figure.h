// SPDX-License-Identifier: Apache-2.0
// The shown figure: one frame's geometry, the frame that a track shows, and the figure of both tracks as a recipe takes
// it. Does NOT choose frames, weights or the placement (the player does), and does NOT draw (render/recipe.h).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "motion/blend.h"
#include "package/stream_file.h"
#include "package/surface_chunk.h"
#include "render/method.h"
#include "render/recipe.h"

namespace fourdvt {

// One frame of a GOP's decoded geometry: of a layered character frames of one mesh, of a character from cameras a
// surface. A view only: Loading owns what it points to, until the GOP leaves its cache.
struct FrameGeometry {
  const package::ChunkFrames* frames = nullptr;  // null: not there yet, or surfaces are
  const package::StreamIndex* index = nullptr;
  uint32_t row = 0;                                 // of the frame in its GOP
  const package::SurfaceChunk* surfaces = nullptr;  // of a character from cameras; null: not there yet
  explicit operator bool() const { return frames || surfaces; }
};

// A frame of a character from cameras, as a track shows it.
struct SurfaceFrame {
  std::vector<glm::uvec3> faces;
  uint64_t topology_serial = 0;  // changes with the faces; 0: none yet
  std::vector<render::CameraSource> sources;
  render::CameraLook look;  // refers to `sources`; without a picture

  // Places the cameras' pictures of this GOP in the decoded pictures of this rendition of the sequence.
  void place(const package::Character& character, const package::Sequence& sequence,
             const package::Rendition& rendition, const package::SurfaceChunk& chunk);
  // Takes the decoded surface of the frame: positions, and faces if they changed.
  void take(const FrameGeometry& geometry, Positions& positions);
};

// The frame that one track shows, as it goes into the figure: labels and alignment on the GPU, and the mesh blended at
// the present weights. Does not upload the mesh: that is FigureComposer's.
class ShownFrame {
 public:
  // Labels and alignment of the frame, or where its cameras' pictures lie in the rendition's, go on screen; its mesh
  // is stale until it is blended. Errors: GpuFailure.
  Status present(gpu::Device& device, const render::CharacterModel& model, const package::Character& character,
                 const package::Sequence& sequence, const package::Rendition& rendition, const FrameGeometry& geometry);
  bool stale() const { return stale_; }  // the mesh is not that of the presented frame at the present weights
  void markStale() { stale_ = true; }
  void blend(const FrameGeometry& geometry, const motion::BlendWeights& weights);
  void release() { appearance_.reset(); }  // nothing is on screen any more

  const render::Appearance& appearance() const { return *appearance_; }  // of a frame that was presented
  const Positions& positions() const { return positions_; }              // as blended last
  const SurfaceFrame& surface() const { return surface_; }               // of a character from cameras

 private:
  std::optional<render::Appearance> appearance_;
  Positions positions_;
  SurfaceFrame surface_;
  bool stale_ = false;
  std::vector<glm::vec2> alignment_;  // scratch
};

// Mixture of the second track's mesh into the first's.
struct MeshFade {
  float share = 0;     // of the second, 0..1
  glm::vec3 shift{0};  // the second's character frame seen from the first's, as of motion::Entry
};

// One model, whose mesh is that of the shown frame, and the look of each track on it; during a fade there are two looks
// on one cross-faded mesh. Uploads the mesh only when it changes.
class FigureComposer {
 public:
  // Errors: GpuFailure.
  Status setMesh(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh);
  void setModel(render::CharacterModel model) { model_ = std::move(model); }  // of a character from cameras
  bool hasMesh() const { return model_.has_value(); }
  const render::CharacterModel& model() const { return *model_; }  // if hasMesh()

  void markStale() { stale_ = true; }  // the model's mesh is not that of the tracks
  // Uploads the mesh if it is stale. second: null without a fade.
  void compose(gpu::Device& device, const ShownFrame& first, const ShownFrame* second, const MeshFade& fade);
  // Positions of the mesh that was composed last; faded: of two tracks.
  const Positions& shown(const ShownFrame& first, bool faded) const { return faded ? faded_ : first.positions(); }
  // Figure of a character from cameras; valid until the next call.
  render::Figure cameraFigure(const ShownFrame& frame, const render::PictureTextures& picture,
                              const glm::mat4& world_from_character) const;
  // looks: one or two. The figure is valid until the next call.
  render::Figure figure(std::span<const render::Look> looks, float fade, const glm::mat4& world_from_character) const;

 private:
  std::optional<render::CharacterModel> model_;
  bool stale_ = false;
  uint64_t topology_serial_ = 0;  // of the surface that the model has
  Positions faded_;               // scratch
  mutable std::array<render::Look, 2> looks_;
  mutable render::CameraLook camera_look_;
};

}  // namespace fourdvt
