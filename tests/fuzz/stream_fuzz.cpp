// SPDX-License-Identifier: Apache-2.0
// Stream headers ("H" + bytes) and GOP chunks ("C" + frames, vertices, faces, layers, members, references, alignment
// fields as bytes + chunk; the mesh is testing::strandMesh of these counts): accepted ones are consistent, and accepted
// headers are written back as the same bytes.
#include <cstdlib>

#include "../unit/chunk_fixture.h"
#include "package/stream_file.h"

using namespace fourdvt;
using namespace fourdvt::package;

namespace {

void fuzzHeader(std::span<const uint8_t> bytes) {
  const auto read = readStreamHeader(bytes);
  if (!read.ok()) return;
  const StreamIndex& index = read.value();
  for (const SampleTable& table : index.renditions) {
    if (table.samples.size() != index.frame_count) std::abort();
    for (const VideoSample& sample : table.samples) {
      if (sample.frame >= index.frame_count) std::abort();
    }
  }
  for (uint32_t frame : {0u, index.frame_count / 2, index.frame_count - 1}) {
    const ChunkEntry& chunk = index.chunks.at(index.chunkOfFrame(frame));
    if (frame < chunk.first_frame || frame >= chunk.first_frame + chunk.frame_count) std::abort();
  }
  std::vector<uint8_t> again = writeStreamHeader(index);
  again[6] = bytes[6], again[7] = bytes[7];  // reserved
  if (again != std::vector<uint8_t>(bytes.begin(), bytes.end())) std::abort();
}

void requireInRange(int q) {
  if (q < -(1 << 24) || q > 1 << 24) std::abort();
}

void fuzzChunk(std::span<const uint8_t> bytes) {
  if (bytes.size() < 7) return;
  StreamIndex index;
  index.frame_count = 1u + bytes[0] % 32;
  index.vertex_count = 3u + bytes[1];
  index.face_count = 1u + bytes[2];
  index.layer_count = 1u + bytes[3] % 6;
  index.member_count = 1u + bytes[4] % 4;
  index.reference_count = bytes[5] % 33;
  index.alignment_count = bytes[6] % 4;
  index.chunks = {{0, index.frame_count, 0, uint32_t(bytes.size())}};
  const auto decoded =
      decodeChunk(bytes.subspan(7), index, 0, testing::strandMesh(index.vertex_count, index.face_count));
  if (!decoded.ok()) return;
  const ChunkFrames& c = decoded.value();
  const size_t members = size_t(index.frame_count) * index.member_count, vertices = index.vertex_count;
  if (c.positions.size() != members * vertices || c.root.size() != members) std::abort();
  if (c.labels.size() != members * index.layer_count * index.face_count) std::abort();
  if (c.offsets.size() != size_t(index.frame_count) * index.reference_count * vertices) std::abort();
  if (c.alignment.size() != size_t(index.frame_count) * index.alignment_count * vertices) std::abort();
  for (uint8_t label : c.labels) {
    if (label >= 31 && label != 255) std::abort();
  }
  for (const glm::ivec3& q : c.positions) requireInRange(q.x), requireInRange(q.y), requireInRange(q.z);
  for (const glm::ivec3& q : c.offsets) requireInRange(q.x), requireInRange(q.y), requireInRange(q.z);
  for (const glm::ivec2& q : c.alignment) requireInRange(q.x), requireInRange(q.y);
  for (const glm::vec3& r : c.root) {
    if (!(glm::length(r) < 1.75e6f)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::span<const uint8_t> rest(data + 1, size - 1);
  if (data[0] == 'H') fuzzHeader(rest);
  if (data[0] == 'C') fuzzChunk(rest);
  return 0;
}
