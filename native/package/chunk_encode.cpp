// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/bytes.h"
#include "package/character.h"
#include "package/label_coder.h"
#include "package/position_coder.h"

namespace fourdvt::package {
namespace {

constexpr int32_t kMaxQuantised = 1 << 24;

bool consistent(const ChunkFrames& in, const ChunkMesh& mesh) {
  const size_t slots = size_t(in.frame_count) * in.face_count * in.layer_count;
  if (in.frame_count == 0 || in.face_count == 0 || in.layer_count == 0 || in.layer_count > uint32_t(kMaxLayers) ||
      in.vertex_count != mesh.vertexCount() || in.face_count != mesh.faceCount() ||
      in.positions.size() != size_t(in.frame_count) * in.vertex_count || in.labels.size() != slots) {
    return false;
  }
  for (const glm::ivec3& q : in.positions) {
    if (glm::any(glm::greaterThan(glm::abs(q), glm::ivec3(kMaxQuantised)))) return false;
  }
  return std::all_of(in.labels.begin(), in.labels.end(),
                     [](uint8_t label) { return label < kMaxCameras || label == kNoCamera; });
}

}  // namespace

Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames, const ChunkMesh& mesh) {
  if (!consistent(frames, mesh)) return Error{ErrorId::Internal, "GOP chunk: counts, positions or labels out of range"};
  const std::vector<uint8_t> positions = encodePositions(frames, mesh), labels = encodeLabels(frames, mesh);
  ByteWriter out;
  out.u32(static_cast<uint32_t>(positions.size()));
  out.u32(static_cast<uint32_t>(labels.size()));
  out.bytes(positions);
  out.bytes(labels);
  return out.take();
}

}  // namespace fourdvt::package
