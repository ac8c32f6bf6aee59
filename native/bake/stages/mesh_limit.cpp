// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/mesh_limit.h"

#include "capture/mesh_sequence.h"
#include "render/character_model.h"

namespace fourdvt::bake {
namespace {

constexpr uint64_t kTexels = kPlayersTextureSide * render::CharacterModel::kTableWidth;

Status refuse(const std::string& file, uint64_t vertices, uint64_t faces, const std::string& remedy) {
  return Error{ErrorId::InvalidArgument, file + ": " + std::to_string(faces) + " faces and " +
                                             std::to_string(vertices) +
                                             " vertices are more than players hold in textures of " +
                                             std::to_string(kPlayersTextureSide) + " texels; " + remedy};
}

}  // namespace

Status checkLayeredMesh(const std::string& file, uint64_t vertices, uint64_t faces) {
  if (render::layeredTableTexels(vertices, faces) <= kTexels) return {};
  return refuse(file, vertices, faces,
                "simplify the mesh to at most " + std::to_string(kTexels / 6) + " faces, the same way in all frames");
}

Status checkSurface(const std::string& file, uint64_t vertices, uint64_t faces) {
  if (render::surfaceTableTexels(vertices, faces) <= kTexels) return {};
  return refuse(file, vertices, faces,
                "simplify the mesh, or, if the topology is per-frame, bake with --faces 150000 or fewer");
}

std::string meshFile(const capture::CaptureSequence& sequence, uint32_t frame) {
  return sequence.packed_positions.empty() ? capture::meshPath(sequence, frame) : sequence.packed_positions;
}

}  // namespace fourdvt::bake
