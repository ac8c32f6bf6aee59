// SPDX-License-Identifier: Apache-2.0
#include "package/position_coder.h"

#include "base/bytes.h"
#include "package/position_model.h"

namespace fourdvt::package {

bool decodePositions(std::span<const uint8_t> bytes, const ChunkMesh& mesh, ChunkFrames& out) {
  ByteReader in(bytes);
  const uint32_t base_scale = in.u32();
  if (!in.ok()) return false;
  BinaryDecoder decoder(in.bytes(in.remaining()));
  PositionModel model(decoder, mesh, base_scale);
  for (uint32_t f = 0; f < out.frame_count; ++f) {
    out.positions.resize(size_t(f + 1) * out.vertex_count);
    if (!model.frame(&out.positions[size_t(f) * out.vertex_count]) || decoder.overrun()) return false;
  }
  return decoder.finished();
}

}  // namespace fourdvt::package
