// SPDX-License-Identifier: Apache-2.0
// Shown figure: one frame's geometry, the frame of a track, and the figure of both tracks as input of a recipe. Frames,
// weights and placement come from the player; drawing: render/recipe.h.
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

// View of one frame of a GOP's decoded geometry: for a layered character, a row of frames of one mesh; for a character
// from cameras, a surface. Loading owns the data until the GOP leaves its cache.
struct FrameGeometry {
  const package::ChunkFrames* frames = nullptr;  // null: not loaded, or `surfaces` in use
  const package::StreamIndex* index = nullptr;
  uint32_t row = 0;                                 // row of the frame in its GOP
  const package::SurfaceChunk* surfaces = nullptr;  // character from cameras; null: not loaded
  explicit operator bool() const { return frames || surfaces; }
};

// Frame of a character from cameras on a track.
struct SurfaceFrame {
  std::vector<glm::uvec3> faces;
  uint64_t topology_serial = 0;  // changes with the faces; 0: no faces
  std::vector<render::CameraSource> sources;
  render::CameraLook look;  // borrows `sources`; excludes the picture

  // Computes the rectangles of the cameras' pictures of this GOP in the decoded pictures of this rendition.
  void place(const package::Character& character, const package::Sequence& sequence,
             const package::Rendition& rendition, const package::SurfaceChunk& chunk);
  // Copies the frame's decoded surface: positions, and faces if they changed.
  void take(const FrameGeometry& geometry, Positions& positions);
};

// Frame of one track as part of the figure: labels and alignment on the GPU, and the mesh blended at the present
// weights. FigureComposer uploads the mesh.
class ShownFrame {
 public:
  // Uploads the frame's labels and alignment, or places its cameras' pictures in the rendition's; the mesh is stale
  // until it is blended. Errors: GpuFailure.
  Status present(gpu::Device& device, const render::CharacterModel& model, const package::Character& character,
                 const package::Sequence& sequence, const package::Rendition& rendition, const FrameGeometry& geometry);
  bool stale() const { return stale_; }  // mesh differs from the presented frame at the present weights
  void markStale() { stale_ = true; }
  void blend(const FrameGeometry& geometry, const motion::BlendWeights& weights);
  void release() { appearance_.reset(); }  // removes the frame from the screen

  const render::Appearance& appearance() const { return *appearance_; }  // requires a presented frame
  const Positions& positions() const { return positions_; }              // last blended mesh
  const SurfaceFrame& surface() const { return surface_; }               // character from cameras

 private:
  std::optional<render::Appearance> appearance_;
  Positions positions_;
  SurfaceFrame surface_;
  bool stale_ = false;
  std::vector<glm::vec2> alignment_;  // scratch
};

// Mixture of the second track's mesh into the first's.
struct MeshFade {
  float share = 0;     // second track's share, 0..1
  glm::vec3 shift{0};  // second's character frame seen from the first's, as motion::Entry
};

// One model with the mesh of the shown frame, and one look per track on it; during a fade two looks share one
// cross-faded mesh. Uploads the mesh only if it changed.
class FigureComposer {
 public:
  // Errors: GpuFailure.
  Status setMesh(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh);
  void setModel(render::CharacterModel model) { model_ = std::move(model); }  // character from cameras
  bool hasMesh() const { return model_.has_value(); }
  const render::CharacterModel& model() const { return *model_; }  // requires hasMesh()

  void markStale() { stale_ = true; }  // the model's mesh is out of date
  // Uploads the mesh if it is stale. second: null without a fade.
  void compose(gpu::Device& device, const ShownFrame& first, const ShownFrame* second, const MeshFade& fade);
  // Positions of the last composed mesh; faded: of two tracks.
  const Positions& shown(const ShownFrame& first, bool faded) const { return faded ? faded_ : first.positions(); }
  // Figure of a character from cameras; valid until the next call.
  render::Figure cameraFigure(const ShownFrame& frame, const render::PictureTextures& picture,
                              const glm::mat4& world_from_character) const;
  // looks: one or two. The figure is valid until the next call.
  render::Figure figure(std::span<const render::Look> looks, float fade, const glm::mat4& world_from_character) const;

 private:
  std::optional<render::CharacterModel> model_;
  bool stale_ = false;
  uint64_t topology_serial_ = 0;  // surface now in the model
  Positions faded_;               // scratch
  mutable std::array<render::Look, 2> looks_;
  mutable render::CameraLook camera_look_;
};

}  // namespace fourdvt
