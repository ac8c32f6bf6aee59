// SPDX-License-Identifier: Apache-2.0
// GPU resources of one character: corner data that never changes, and the mesh shown now.
// Does NOT decode or schedule anything (player/) and does NOT decide how to blend (layered_pass).
#pragma once

#include <span>
#include <vector>

#include "gpu/device.h"
#include "package/base_mesh.h"
#include "package/character.h"
#include "render/picture_textures.h"

namespace fourdvt::render {

// Fills the tables of seam feathering (algorithms/rendering.md). labels: [rank][face]; a label that is no camera counts
// as empty. packed[face]: 5 bits per rank, 31 = empty, rank 0 lowest. masks[vertex]: bit c is cleared unless camera c
// is in the set of every incident face. Both tables are at least as long as faces and vertices, and all their bits are
// set before the call.
void packLabels(const std::vector<glm::uvec3>& face_vertices, std::span<const uint8_t> labels, int camera_count,
                std::span<uint32_t> packed, std::span<uint32_t> masks);

// Texels of the largest table that a mesh needs. A texture of side n holds n · CharacterModel::kTableWidth of them.
constexpr uint64_t layeredTableTexels(uint64_t vertices, uint64_t faces) {
  return 2 * (vertices > 3 * faces ? vertices : 3 * faces);
}
constexpr uint64_t surfaceTableTexels(uint64_t vertices, uint64_t faces) {
  const uint64_t neighbours = vertices + 1 + 6 * faces;
  return neighbours > 2 * vertices ? neighbours : 2 * vertices;
}

// True if every edge belongs to two faces, which run along it in opposite directions.
bool isClosedSurface(const std::vector<glm::uvec3>& face_vertices);

class CharacterModel {
 public:
  // Cameras, UVs and faces are fixed from here on. Errors: GpuFailure.
  static Result<CharacterModel> create(gpu::Device& device, const package::Character& character,
                                       const package::BaseMesh& mesh);
  // For a character from cameras: a surface of up to its vertices and faces, whose topology may change. Call
  // setTopology before setPositions. Errors: GpuFailure.
  static Result<CharacterModel> createForSurfaces(gpu::Device& device, const package::Character& character);
  // Every face's corners are below `vertices`. Errors: InvalidArgument: more than it was made for.
  Status setTopology(gpu::Device& device, std::span<const glm::uvec3> faces, uint32_t vertices);
  // The mesh to draw: vertex_count points in the character's frame, metres. Uploads positions and vertex normals.
  void setPositions(gpu::Device& device, std::span<const glm::vec3> positions);

  // What the passes bind. Textures are 2-D tables addressed as index → (index % width, index / width).
  static constexpr int kTableWidth = 256;
  // RGBA32F, 2 texels per corner: uv.x, uv.y, vertex index (exact below 2^24), unused; then uv_from_tangents, column by
  // column (base/mesh.h).
  gpu::Texture corners;             // none for surfaces
  gpu::Texture corner_vertices;     // R32UI, the vertex of every corner; surfaces only
  gpu::Texture positions_normals;   // RGBA32F, 2 texels per vertex: position, normal
  gpu::IndexBuffer shadow_corners;  // of coarser faces, which cast nearly the same shadow; none: all cast
  int shadow_corner_count = 0;
  std::vector<glm::vec4> camera_centres;  // xyz, w unused
  int layer_count = 0, camera_count = 0;
  uint32_t vertex_count = 0, face_count = 0;
  BoundingBox bounds;
  double ground_y_m = 0;
  float length_scale = 1;        // of all lengths that are said to suit a person (package::Character)
  float sweep_band_m = 0;        // package::DrawingMethod's; above 0 it takes the place of SweepOptions::band_m
  BoundingBox frame_bounds;      // of the positions shown
  uint64_t geometry_serial = 0;  // 0: none yet; unique over all models and calls of setPositions
  uint64_t topology_serial = 0;  // likewise, of setTopology
  bool closed_surface = false;   // isClosedSurface: back faces are never seen

  const std::vector<glm::uvec3>& faces() const { return face_vertices_; }
  // shared_corners.h; none for surfaces.
  const std::vector<uint32_t>& cornersBefore() const { return corners_before_; }
  // What a surface may have.
  uint32_t mostVertices() const { return most_vertices_; }
  uint32_t mostFaces() const { return most_faces_; }

 private:
  static CharacterModel emptyModel(const package::Character& character);

  std::vector<glm::uvec3> face_vertices_;
  std::vector<uint32_t> corners_before_;
  uint32_t most_vertices_ = 0, most_faces_ = 0;  // of a surface
  std::vector<glm::vec3> normals_;               // scratch
  std::vector<glm::vec4> table_;                 // scratch
  std::vector<uint32_t> corner_table_;           // scratch
};

}  // namespace fourdvt::render
