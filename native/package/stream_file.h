// SPDX-License-Identifier: Apache-2.0
// The per-motion stream (.bin): header, index of chunks, sample tables of every rendition; then one chunk per GOP
// with vertex positions and labels, or, of a character from cameras, with surfaces (surface_chunk.h). Byte layout:
// FORMAT.md. The reader takes only what the header span holds; the chunks are fetched by range.
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
  uint64_t offset = 0;  // in the .bin
  uint32_t bytes = 0;
  uint64_t hash = 0;  // of the chunk (base/hash.h)
};

struct VideoSample {    // in decoding order
  uint64_t offset = 0;  // in the .mp4
  uint32_t bytes = 0;
  uint32_t frame = 0;  // presentation index: pairs with the mesh frame
  bool key = false;
};

struct ByteSpan {
  uint64_t offset = 0, bytes = 0;
};

struct SampleTable {                         // one rendition
  std::vector<uint8_t> decoder_description;  // avcC / empty for codecs that need none
  std::vector<VideoSample> samples;          // grouped by chunk: a chunk's samples are contiguous in file and list
  std::vector<uint32_t> chunk_first_sample;  // size chunks+1
  std::vector<uint64_t> chunk_hash;          // of the bytes of videoOf(chunk)
  // Where a chunk's samples lie in the .mp4.
  ByteSpan videoOf(uint32_t chunk) const;
};

struct StreamIndex {
  // layer_count 0: a camera stream, whose vertex and face counts are the most that any frame has.
  uint32_t frame_count = 0, vertex_count = 0, face_count = 0, layer_count = 0;
  uint32_t member_count = 1, reference_count = 0;
  uint32_t alignment_count = 0;  // member_count - 1, or 0: not aligned
  glm::vec3 position_origin{0};  // position = origin + step * q
  float position_step_m = 0;
  float alignment_step_m = 0;
  std::vector<ChunkEntry> chunks;  // contiguous frames 0..frame_count
  std::vector<SampleTable> renditions;
  // The same GOPs with the same labels and larger steps of all else, for low renditions; empty: there are none.
  std::vector<ChunkEntry> coarse_chunks;
  float coarse_step_m = 0;
  // An index of the coarse chunks in place of the others, without renditions.
  StreamIndex coarse() const;
  // The chunk that holds a frame.
  uint32_t chunkOfFrame(uint32_t frame) const;
};

// The most memory that one GOP may take in a reader, in bytes: its chunk as it is in the file and decoded, and its
// video samples. Few bytes can say a great deal: frames that do not move take next to none.
constexpr uint64_t kMaxChunkBytes = 64u << 20, kMaxDecodedChunkBytes = 256u << 20, kMaxGopVideoBytes = 64u << 20;
// Whether every GOP keeps to them.
bool keepsMemoryLimits(const StreamIndex& index);

// Header bytes with offsets already final. `stream_header_bytes` in the manifest is the size of the result.
std::vector<uint8_t> writeStreamHeader(const StreamIndex& index);
// Checks magic, version, counts against each other and against the span; frames covered exactly once; every chunk
// starts on a key sample, samples of a chunk are contiguous and cover its frames once; keepsMemoryLimits. Errors:
// StreamInvalid.
Result<StreamIndex> readStreamHeader(std::span<const uint8_t> bytes);

// One chunk's contents: positions quantised to int32 (position = origin + step * q), labels planar.
// Every list runs frame by frame, so that a decoder appends.
struct ChunkFrames {
  uint32_t frame_count = 0, vertex_count = 0, face_count = 0, layer_count = 0;
  uint32_t member_count = 1, reference_count = 0, alignment_count = 0;
  std::vector<glm::ivec3> positions;  // [frame][member][vertex]
  std::vector<uint8_t> labels;        // [frame][member][layer][face], kNoCamera for empty
  std::vector<glm::ivec3> offsets;    // [frame][reference][vertex], position steps: corrections of the mesh blend
  // [frame][member - 1][vertex], alignment steps along the vertex's tangents (base/mesh.h): what lies at this
  // vertex in member 0 lies displaced by this in the member.
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

// Arithmetic coding with predictions along the mesh; every chunk decodes alone. Errors: Internal.
Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames, const ChunkMesh& mesh);
// The same frames with steps of positions, offsets and alignment `scale` times as large. Residuals count as 0 up to 0.8
// steps, so that no value is further off than that along an axis. Errors: Internal.
Result<std::vector<uint8_t>> encodeCoarseChunk(const ChunkFrames& frames, const ChunkMesh& mesh, double scale);
// mesh: makeChunkMesh of the character's decoded base mesh. Errors: StreamInvalid if corrupt, or if the counts of index
// and mesh differ.
Result<ChunkFrames> decodeChunk(std::span<const uint8_t> bytes, const StreamIndex& index, uint32_t chunk,
                                const ChunkMesh& mesh);

}  // namespace fourdvt::package
