// SPDX-License-Identifier: Apache-2.0
#include "package/coding/field_coder.h"
#include "package/coding/field_model.h"

namespace fourdvt::package {
namespace {

// Encodes number `field` of `count` fields. fields: [frame][field][vertex].
template <int N>
std::vector<uint8_t> encodeField(std::vector<glm::vec<N, int>> fields, const ChunkFrames& frames, uint32_t count,
                                 uint32_t field, const ChunkMesh& mesh) {
  BinaryEncoder encoder;
  FieldModel model(encoder, mesh, N);
  for (uint32_t f = 0; f < frames.frame_count; ++f)
    model.frame(&fields[(size_t(f) * count + field) * frames.vertex_count]);
  return encoder.take();
}

}  // namespace

std::vector<uint8_t> encodeOffsets(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t reference) {
  return encodeField<3>(frames.offsets, frames, frames.reference_count, reference, mesh);
}

std::vector<uint8_t> encodeAlignment(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t field) {
  return encodeField<2>(frames.alignment, frames, frames.alignment_count, field, mesh);
}

}  // namespace fourdvt::package
