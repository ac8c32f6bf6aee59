// SPDX-License-Identifier: Apache-2.0
// Limits and counts of stream headers and chunks. Internal to package/.
#pragma once

#include <cmath>
#include <string>

#include "base/result.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Sequence limits, in the manifest and in the stream header alike.
constexpr uint32_t kMaxFrames = 1u << 20;
constexpr uint32_t kMaxCount = 1u << 22;  // vertices, faces
constexpr uint32_t kMaxRenditions = 16;

// Checks a StreamIndex or ChunkFrames. A plain sequence has no blend corrections and no alignment.
template <class Counts>
bool validCounts(const Counts& counts) {
  return counts.layer_count >= 1 && counts.layer_count <= uint32_t(kMaxLayers) && counts.member_count >= 1 &&
         counts.member_count <= uint32_t(kMaxMembers) && counts.reference_count <= uint32_t(kMaxReferences) &&
         (counts.member_count > 1 || counts.reference_count == 0) &&
         (counts.alignment_count == 0 || counts.alignment_count == counts.member_count - 1);
}

// True for a camera stream (surface_chunk.h): its chunks hold surfaces, without layers or members.
inline bool isCameraStream(const StreamIndex& index) {
  return index.layer_count == 0 && index.member_count == 1 && index.reference_count == 0 && index.alignment_count == 0;
}

// Number of coded parts of a chunk; the chunk begins with their lengths (FORMAT.md). Order: positions and labels of
// each member, then offsets, alignment.
template <class Counts>
uint32_t partCount(const Counts& counts) {
  return 2 * counts.member_count + counts.reference_count + counts.alignment_count;
}

// Decoded bytes per frame, equal to ChunkFrames::bytes() of a one-frame chunk with these counts. Camera streams:
// positions and faces, as if every frame had its own topology.
template <class Counts>
uint64_t decodedFrameBytes(const Counts& counts) {
  const uint64_t vertices = counts.vertex_count, faces = counts.face_count;
  if (counts.layer_count == 0) return 12 * (vertices + faces);
  return counts.member_count * (vertices * sizeof(glm::ivec3) + counts.layer_count * faces + sizeof(glm::vec3)) +
         counts.reference_count * vertices * sizeof(glm::ivec3) +
         counts.alignment_count * vertices * sizeof(glm::ivec2);
}

// Copies all counts but frame_count between StreamIndex and ChunkFrames.
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

// Error of a corrupt chunk, for every kind of stream.
inline Error invalidChunk(const char* what) {
  return {ErrorId::StreamInvalid, std::string("GOP chunk: ") + what + "; the .bin file is damaged, upload it again"};
}

}  // namespace fourdvt::package
