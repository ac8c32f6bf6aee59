// SPDX-License-Identifier: Apache-2.0
// GPU resources of one character: constant corner data and the current mesh. Blending is in LayeredPass, scheduling in
// player/.
#pragma once

#include <span>
#include <vector>

#include "gpu/device.h"
#include "package/base_mesh.h"
#include "package/character.h"
#include "render/picture_textures.h"

namespace fourdvt::render {

// Fills the tables of seam feathering (algorithms/rendering.md). labels: [rank][face]; a label without a camera counts
// as empty. packed[face]: 5 bits per rank, 31 = empty, rank 0 lowest. masks[vertex]: bit c is cleared unless camera c
// is in the label set of every incident face. Requires `packed` and `masks` to have at least as many entries as faces
// and vertices, all bits set.
void packLabels(const std::vector<glm::uvec3>& face_vertices, std::span<const uint8_t> labels, int camera_count,
                std::span<uint32_t> packed, std::span<uint32_t> masks);

// Texels of the largest table that a mesh requires. A texture of side n holds n · CharacterModel::kTableWidth of them.
constexpr uint64_t layeredTableTexels(uint64_t vertices, uint64_t faces) {
  return 2 * (vertices > 3 * faces ? vertices : 3 * faces);
}
constexpr uint64_t surfaceTableTexels(uint64_t vertices, uint64_t faces) {
  const uint64_t neighbours = vertices + 1 + 6 * faces;
  return neighbours > 2 * vertices ? neighbours : 2 * vertices;
}

// True if every edge belongs to two faces that traverse it in opposite directions.
bool isClosedSurface(const std::vector<glm::uvec3>& face_vertices);

class CharacterModel {
 public:
  // Fixes cameras, UVs and faces. Errors: GpuFailure.
  static Result<CharacterModel> create(gpu::Device& device, const package::Character& character,
                                       const package::BaseMesh& mesh);
  // For a character from cameras: a surface up to the character's vertex and face limits, with a topology that may
  // change. Call setTopology before setPositions. Errors: GpuFailure.
  static Result<CharacterModel> createForSurfaces(gpu::Device& device, const package::Character& character);
  // Requires all corners of the faces below `vertices`. Errors: InvalidArgument: counts above the limits.
  Status setTopology(gpu::Device& device, std::span<const glm::uvec3> faces, uint32_t vertices);
  // Uploads positions and vertex normals of the mesh to draw: vertex_count points in the character's frame, metres.
  void setPositions(gpu::Device& device, std::span<const glm::vec3> positions);

  // Resources bound by the passes. Textures are 2-D tables addressed as index → (index % width, index / width).
  static constexpr int kTableWidth = 256;
  // RGBA32F, 2 texels per corner: uv.x, uv.y, vertex index (exact below 2^24), unused; then uv_from_tangents, column by
  // column (base/mesh.h).
  gpu::Texture corners;             // null for surfaces
  gpu::Texture corner_vertices;     // R32UI, vertex of every corner; surfaces only
  gpu::Texture positions_normals;   // RGBA32F, 2 texels per vertex: position, normal
  gpu::IndexBuffer shadow_corners;  // coarser faces with nearly the same shadow; null: all faces cast
  int shadow_corner_count = 0;
  std::vector<glm::vec4> camera_centres;  // xyz, w unused
  int layer_count = 0, camera_count = 0;
  uint32_t vertex_count = 0, face_count = 0;
  BoundingBox bounds;
  double ground_y_m = 0;
  float length_scale = 1;        // factor of all lengths that are tuned for a person (package::Character)
  float sweep_band_m = 0;        // package::DrawingMethod's; above 0 it replaces SweepOptions::band_m
  BoundingBox frame_bounds;      // bounds of the current positions
  uint64_t geometry_serial = 0;  // 0: no positions; unique over all models and calls of setPositions
  uint64_t topology_serial = 0;  // 0: no faces; unique over all models and calls of setTopology
  bool closed_surface = false;   // isClosedSurface: back faces are never visible

  const std::vector<glm::uvec3>& faces() const { return face_vertices_; }
  // Sharing candidates of shared_corners.h; empty for surfaces.
  const std::vector<uint32_t>& cornersBefore() const { return corners_before_; }
  // Limits of a surface.
  uint32_t maxVertices() const { return max_vertices_; }
  uint32_t maxFaces() const { return max_faces_; }

 private:
  static CharacterModel emptyModel(const package::Character& character);

  std::vector<glm::uvec3> face_vertices_;
  std::vector<uint32_t> corners_before_;
  uint32_t max_vertices_ = 0, max_faces_ = 0;  // limits of a surface
  std::vector<glm::vec3> normals_;             // scratch
  std::vector<glm::vec4> table_;               // scratch
  std::vector<uint32_t> corner_table_;         // scratch
};

}  // namespace fourdvt::render
