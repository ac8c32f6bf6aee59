// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/bytes.h"
#include "package/character.h"
#include "package/chunk_counts.h"
#include "package/field_coder.h"
#include "package/label_coder.h"
#include "package/position_coder.h"
#include "package/residual_model.h"

namespace fourdvt::package {
namespace {

bool countsMatch(const ChunkFrames& in, const ChunkMesh& mesh) {
  const size_t frames = in.frame_count, members = frames * in.member_count;
  return frames > 0 && in.vertex_count == mesh.vertexCount() && in.face_count == mesh.faceCount() && validCounts(in) &&
         in.positions.size() == members * in.vertex_count &&
         in.labels.size() == members * in.layer_count * in.face_count &&
         in.offsets.size() == frames * in.reference_count * in.vertex_count &&
         in.alignment.size() == frames * in.alignment_count * in.vertex_count && in.root.size() == members;
}

bool valuesFit(const ChunkFrames& in) {
  return std::all_of(in.positions.begin(), in.positions.end(), inRange) &&
         std::all_of(in.offsets.begin(), in.offsets.end(), inRange) &&
         std::all_of(in.alignment.begin(), in.alignment.end(),
                     [](const glm::ivec2& q) { return inRange(glm::ivec3(q, 0)); }) &&
         std::all_of(in.root.begin(), in.root.end(), validRoot) &&
         std::all_of(in.labels.begin(), in.labels.end(),
                     [](uint8_t label) { return label < kMaxCameras || label == kNoCamera; });
}

// coarse_scale: 0: exactly the frames.
Result<std::vector<uint8_t>> encode(const ChunkFrames& frames, const ChunkMesh& mesh, double coarse_scale) {
  if (!countsMatch(frames, mesh)) return Error{ErrorId::Internal, "GOP chunk: counts do not match its contents"};
  if (!valuesFit(frames)) return Error{ErrorId::Internal, "GOP chunk: a value is out of range"};
  std::vector<std::vector<uint8_t>> parts;
  for (uint32_t m = 0; m < frames.member_count; ++m) {
    parts.push_back(encodePositions(frames, mesh, m, coarse_scale));
    parts.push_back(encodeLabels(frames, mesh, m));
  }
  for (uint32_t r = 0; r < frames.reference_count; ++r) parts.push_back(encodeOffsets(frames, mesh, r, coarse_scale));
  for (uint32_t a = 0; a < frames.alignment_count; ++a) parts.push_back(encodeAlignment(frames, mesh, a, coarse_scale));
  ByteWriter out;
  for (const auto& part : parts) out.u32(static_cast<uint32_t>(part.size()));
  for (const auto& part : parts) out.bytes(part);
  for (const glm::vec3& root : frames.root) {
    for (int k = 0; k < 3; ++k) out.f32(root[k]);
  }
  return out.take();
}

}  // namespace

Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames, const ChunkMesh& mesh) {
  return encode(frames, mesh, 0);
}

Result<std::vector<uint8_t>> encodeCoarseChunk(const ChunkFrames& frames, const ChunkMesh& mesh, double scale) {
  if (!(scale >= 1)) return Error{ErrorId::Internal, "GOP chunk: coarse steps must not be smaller"};
  return encode(frames, mesh, scale);
}

}  // namespace fourdvt::package
