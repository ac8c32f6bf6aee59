// SPDX-License-Identifier: Apache-2.0
// Decoding of GOP chunks; chunk_encode.cpp is the mirror image. Byte layout: FORMAT.md.
#include "base/bytes.h"
#include "package/character.h"
#include "package/label_coder.h"
#include "package/position_coder.h"
#include "package/stream_file.h"

namespace fourdvt::package {
namespace {

Error invalid(const char* what) {
  return {ErrorId::StreamInvalid, std::string("GOP chunk: ") + what + "; the .bin file is damaged, upload it again"};
}

}  // namespace

Result<ChunkFrames> decodeChunk(std::span<const uint8_t> bytes, const StreamIndex& index, uint32_t chunk,
                                const ChunkMesh& mesh) {
  if (chunk >= index.chunks.size()) return invalid("no such GOP");
  ChunkFrames out{index.chunks[chunk].frame_count, index.vertex_count, index.face_count, index.layer_count, {}, {}};
  if (out.vertex_count != mesh.vertexCount() || out.face_count != mesh.faceCount() || out.layer_count == 0 ||
      out.layer_count > uint32_t(kMaxLayers)) {
    return invalid("vertex, face or layer count is not the mesh's");
  }
  ByteReader in(bytes);
  const uint32_t position_bytes = in.u32(), label_bytes = in.u32();
  const auto positions = in.bytes(position_bytes);
  const auto labels = in.bytes(label_bytes);
  if (!in.ok() || in.remaining() != 0) return invalid("length differs from its header");
  if (!decodePositions(positions, mesh, out)) return invalid("positions do not decode");
  if (!decodeLabels(labels, mesh, out)) return invalid("labels do not decode");
  return out;
}

}  // namespace fourdvt::package
