// SPDX-License-Identifier: Apache-2.0
#include "package/coarse_residual.h"
#include "package/field_coder.h"
#include "package/field_model.h"

namespace fourdvt::package {
namespace {

// Encodes number `field` of `count` fields. fields: [frame][field][vertex].
template <int N>
std::vector<uint8_t> encodeField(std::vector<glm::vec<N, int>> fields, const ChunkFrames& frames, uint32_t count,
                                 uint32_t field, const ChunkMesh& mesh, double coarse_scale) {
  BinaryEncoder encoder;
  FieldModel model(encoder, mesh, N);
  for (uint32_t f = 0; f < frames.frame_count; ++f) {
    glm::vec<N, int>* values = &fields[(size_t(f) * count + field) * frames.vertex_count];
    if (coarse_scale == 0)
      model.frame(values);
    else
      model.frame(values, [&](uint32_t v, const glm::ivec3& p) { return coarseResidual(values[v], coarse_scale, p); });
  }
  return encoder.take();
}

}  // namespace

std::vector<uint8_t> encodeOffsets(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t reference,
                                   double coarse_scale) {
  return encodeField<3>(frames.offsets, frames, frames.reference_count, reference, mesh, coarse_scale);
}

std::vector<uint8_t> encodeAlignment(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t field,
                                     double coarse_scale) {
  return encodeField<2>(frames.alignment, frames, frames.alignment_count, field, mesh, coarse_scale);
}

}  // namespace fourdvt::package
