// SPDX-License-Identifier: Apache-2.0
// GPU resources of one character: static corner data, per-frame geometry and labels, and picture textures.
// Does NOT decode or schedule anything (player/) and does NOT decide how to blend (layered_pass).
#pragma once

#include <span>
#include <vector>

#include "gpu/device.h"
#include "package/base_mesh.h"
#include "package/character.h"

namespace fourdvt::render {

// One instant, in base-mesh order.
struct FrameGeometry {
  std::span<const glm::vec3> positions;  // vertex_count, world metres
  std::span<const uint8_t> labels;       // layer_count × face_count, planar; kNoCamera for empty
};

// A decoded tiled picture on the GPU: either three R8 planes (our own BT.709 matrix in the shader) or one RGBA8
// texture that the page filled from a VideoFrame.
struct PictureTextures {
  enum class Kind { I420, Rgba } kind = Kind::I420;
  gpu::Texture y, u, v;
  gpu::Texture rgba;
};

Result<PictureTextures> createPicture(gpu::Device& device, int width, int height, PictureTextures::Kind kind);
void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame);

// Seam feathering's tables (ALGORITHMS 2). `labels`: layer_count × face_vertices.size(), planar; a label that is no
// camera counts as empty. packed[face]: 5 bits a slot, 31 = empty, slot 0 lowest. masks[vertex]: bit c is cleared
// unless camera c is in the set of every incident face. Both are at least as long as faces and vertices and hold ones.
void packLabels(const std::vector<glm::uvec3>& face_vertices, std::span<const uint8_t> labels, int layer_count,
                int camera_count, std::vector<uint32_t>& packed, std::vector<uint32_t>& masks);

// Every edge has two faces of opposite direction.
bool isClosedSurface(const std::vector<glm::uvec3>& face_vertices);

class CharacterModel {
 public:
  // Cameras, UVs and faces do not change after this. Errors: GpuFailure.
  static Result<CharacterModel> create(gpu::Device& device, const package::Character& character,
                                       const package::BaseMesh& mesh);
  // Uploads positions, vertex normals, labels and the per-vertex camera masks of seam feathering
  // (bit c of a vertex: camera c is in the label set of every incident face; ALGORITHMS 2).
  void setGeometry(gpu::Device& device, const FrameGeometry& frame);
  // With a rendition's tile layout; needed before drawing.
  void setLayout(const package::Rendition& rendition);

  // What layered_pass binds. Textures are 2-D tables addressed as index → (index % width, index / width).
  static constexpr int kTableWidth = 256;
  gpu::Texture corners;                    // RGBA32F, 3*face_count: uv.x, uv.y, vertex index (exact below 2^24), unused
  gpu::Texture positions_normals;          // RGBA32F, 2 texels a vertex: position, normal
  gpu::Texture vertex_masks;               // R32UI, vertex_count
  gpu::Texture labels;                     // R32UI, face_count: 5 bits a slot, 31 = empty, slot 0 lowest
  std::vector<glm::vec4> camera_centres;   // xyz, w unused
  std::vector<glm::vec4> camera_forwards;  // unit optical axes, w unused
  std::vector<glm::vec4> layer_rects_uv;   // x, y, width, height in picture texture coordinates
  glm::vec2 picture_size{1};
  int layer_count = 0, camera_count = 0;
  uint32_t vertex_count = 0, face_count = 0;
  BoundingBox bounds;
  double ground_y_m = 0;
  BoundingBox frame_bounds;      // of the positions shown
  uint64_t geometry_serial = 0;  // 0: none yet; unique over all models and calls of setGeometry
  bool closed_surface = false;   // every edge has two faces of opposite direction: back faces are never seen

 private:
  std::vector<glm::uvec3> face_vertices_;
  std::vector<glm::vec3> normals_;        // scratch
  std::vector<glm::vec4> table_;          // scratch
  std::vector<uint32_t> masks_, packed_;  // scratch
};

}  // namespace fourdvt::render
