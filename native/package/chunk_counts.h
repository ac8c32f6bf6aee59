// SPDX-License-Identifier: Apache-2.0
// What stream headers and chunks may hold. Internal to package/.
#pragma once

#include <cmath>
#include <string>

#include "base/result.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Limits of a sequence, in the manifest and in its stream's header alike.
constexpr uint32_t kMaxFrames = 1u << 20;
constexpr uint32_t kMaxCount = 1u << 22;  // vertices, faces
constexpr uint32_t kMaxRenditions = 16;

// counts: StreamIndex or ChunkFrames. A plain sequence has no blend to correct and nothing to align.
template <class Counts>
bool validCounts(const Counts& counts) {
  return counts.layer_count >= 1 && counts.layer_count <= uint32_t(kMaxLayers) && counts.member_count >= 1 &&
         counts.member_count <= uint32_t(kMaxMembers) && counts.reference_count <= uint32_t(kMaxReferences) &&
         (counts.member_count > 1 || counts.reference_count == 0) &&
         (counts.alignment_count == 0 || counts.alignment_count == counts.member_count - 1);
}

// Of a camera stream (surface_chunk.h): its chunks hold surfaces, which have no layers and no members to blend.
inline bool isCameraStream(const StreamIndex& index) {
  return index.layer_count == 0 && index.member_count == 1 && index.reference_count == 0 && index.alignment_count == 0;
}

// Coded parts of a chunk, each with its length at the chunk's beginning (FORMAT.md): a member's positions, its labels,
// the next member's …, offsets, alignment.
template <class Counts>
uint32_t partCount(const Counts& counts) {
  return 2 * counts.member_count + counts.reference_count + counts.alignment_count;
}

// What one decoded frame takes: ChunkFrames::bytes() of a chunk, by its counts; of a camera stream, positions and
// faces, as if every frame had its own.
template <class Counts>
uint64_t decodedFrameBytes(const Counts& counts) {
  const uint64_t vertices = counts.vertex_count, faces = counts.face_count;
  if (counts.layer_count == 0) return 12 * (vertices + faces);
  return counts.member_count * (vertices * sizeof(glm::ivec3) + counts.layer_count * faces + sizeof(glm::vec3)) +
         counts.reference_count * vertices * sizeof(glm::ivec3) +
         counts.alignment_count * vertices * sizeof(glm::ivec2);
}

// StreamIndex → ChunkFrames or back; all counts but that of the frames, which differ.
template <class From, class To>
void copyCounts(const From& from, To& to) {
  to.vertex_count = from.vertex_count;
  to.face_count = from.face_count;
  to.layer_count = from.layer_count;
  to.member_count = from.member_count;
  to.reference_count = from.reference_count;
  to.alignment_count = from.alignment_count;
}

inline bool validRoot(const glm::vec3& root) {
  constexpr float kMax = 1e6f;  // metres, radians
  return std::fabs(root.x) <= kMax && std::fabs(root.y) <= kMax && std::fabs(root.z) <= kMax;
}

// The error of a chunk that does not decode, whatever kind of stream it is of.
inline Error invalidChunk(const char* what) {
  return {ErrorId::StreamInvalid, std::string("GOP chunk: ") + what + "; the .bin file is damaged, upload it again"};
}

}  // namespace fourdvt::package
