// SPDX-License-Identifier: Apache-2.0
// Stream of one motion (.bin): header, chunk index, sample tables of every rendition; then one chunk per GOP with
// vertex positions and labels, or, for a character from cameras, surfaces (surface_chunk.h). Byte layout: FORMAT.md.
// The reader needs the header's bytes only; chunks are fetched by range.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::package {

struct ChunkEntry {  // one GOP
  uint32_t first_frame = 0, frame_count = 0;
  uint64_t offset = 0;  // offset in the .bin
  uint32_t bytes = 0;
  uint64_t hash = 0;  // chunk hash (base/hash.h)
};

struct VideoSample {    // in decoding order
  uint64_t offset = 0;  // offset in the .mp4
  uint32_t bytes = 0;
  uint32_t frame = 0;  // presentation index: pairs with the mesh frame
  bool key = false;
};

struct ByteSpan {
  uint64_t offset = 0, bytes = 0;
};

struct SampleTable {                         // one rendition
  std::vector<uint8_t> decoder_description;  // avcC; empty for codecs without one
  std::vector<VideoSample> samples;          // grouped by chunk: a chunk's samples are contiguous in file and list
  std::vector<uint32_t> chunk_first_sample;  // size chunks+1
  std::vector<uint64_t> chunk_hash;          // hash of the bytes of videoOf(chunk)
  // Byte range of a chunk's samples in the .mp4.
  ByteSpan videoOf(uint32_t chunk) const;
};

struct StreamIndex {
  // layer_count 0: a camera stream; vertex and face counts are then the maximum over all frames.
  uint32_t frame_count = 0, vertex_count = 0, face_count = 0, layer_count = 0;
  uint32_t member_count = 1, reference_count = 0;
  uint32_t alignment_count = 0;  // member_count - 1, or 0: not aligned
  glm::vec3 position_origin{0};  // position = origin + step * q
  float position_step_m = 0;
  float alignment_step_m = 0;
  std::vector<ChunkEntry> chunks;  // contiguous frames 0..frame_count
  std::vector<SampleTable> renditions;
  // Chunks of the same GOPs and labels with larger errors, for low renditions; may be empty.
  std::vector<ChunkEntry> coarse_chunks;
  // Index of the coarse chunks in place of the fine ones, without renditions.
  StreamIndex coarse() const;
  // Chunk that contains a frame.
  uint32_t chunkOfFrame(uint32_t frame) const;
};

// Memory limits of one GOP in a reader, in bytes: its chunk, coded and decoded, and its video samples. A limit of the
// coded size alone is not enough: static frames take next to no bytes.
constexpr uint64_t kMaxChunkBytes = 64u << 20, kMaxDecodedChunkBytes = 256u << 20, kMaxGopVideoBytes = 64u << 20;
// Checks every GOP against these limits.
bool keepsMemoryLimits(const StreamIndex& index);

// Serialises a header with final offsets. `stream_header_bytes` in the manifest is the size of the result.
std::vector<uint8_t> writeStreamHeader(const StreamIndex& index);
// Checks magic, version, the counts against each other and the span, and keepsMemoryLimits. Chunks must cover every
// frame once and start on a key sample; their samples must be contiguous and cover their frames once. Errors:
// StreamInvalid.
Result<StreamIndex> readStreamHeader(std::span<const uint8_t> bytes);

// Contents of one chunk: positions quantised to int32 (position = origin + step * q), labels planar. Every list is
// frame-major, so that a decoder appends.
struct ChunkFrames {
  uint32_t frame_count = 0, vertex_count = 0, face_count = 0, layer_count = 0;
  uint32_t member_count = 1, reference_count = 0, alignment_count = 0;
  std::vector<glm::ivec3> positions;  // [frame][member][vertex]
  std::vector<uint8_t> labels;        // [frame][member][layer][face], kNoCamera for empty
  std::vector<glm::ivec3> offsets;    // [frame][reference][vertex], position steps: mesh-blend corrections
  // [frame][member - 1][vertex], alignment steps along the vertex's tangents (base/mesh.h): displacement, in the
  // member, of the detail that member 0 has at this vertex.
  std::vector<glm::ivec2> alignment;
  // [frame][member]: metres along x and z, radians about y since frame 0 of the whole sequence, in the character frame
  // of frame 0.
  std::vector<glm::vec3> root;

  uint64_t bytes() const {  // held in memory
    return positions.size() * sizeof(positions[0]) + labels.size() + offsets.size() * sizeof(offsets[0]) +
           alignment.size() * sizeof(alignment[0]) + root.size() * sizeof(root[0]);
  }
};

struct ChunkMesh;  // chunk_mesh.h

constexpr uint32_t kMaxResidualStep = 1 << 12;
// Units of coded residuals, in steps of the values, 1…kMaxResidualStep. Values are off by up to 0.7 units along an
// axis; 1 is lossless.
struct ResidualSteps {
  uint32_t positions = 1, alignment = 1;  // positions: and offsets
};
// Encodes by arithmetic coding with predictions along the mesh; every chunk decodes alone. Errors: Internal.
Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames, const ChunkMesh& mesh, ResidualSteps steps = {});
// mesh: makeChunkMesh of the decoded base mesh. Errors: StreamInvalid for corrupt bytes or different counts of index
// and mesh.
Result<ChunkFrames> decodeChunk(std::span<const uint8_t> bytes, const StreamIndex& index, uint32_t chunk,
                                const ChunkMesh& mesh);

}  // namespace fourdvt::package
