// SPDX-License-Identifier: Apache-2.0
#include "base/bytes.h"
#include "package/coarse_residual.h"
#include "package/position_coder.h"
#include "package/position_model.h"

namespace fourdvt::package {
namespace {

// Scale from the base pose's lattice to the stream's steps, which are `step` of the positions'. Edges hardly change
// their lengths between poses, so their lengths in frame 0 are compared with those of the base pose.
uint32_t baseScale(const glm::ivec3* positions, const ChunkMesh& mesh, double step) {
  double steps = 0, lattice = 0;
  for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    for (uint32_t u : mesh.earlierOf(v).first(mesh.ring_count[v])) {
      const glm::dvec3 a(positions[v] - positions[u]), b(mesh.base[v] - mesh.base[u]);
      steps += glm::dot(a, a);
      lattice += glm::dot(b, b);
    }
  }
  const double scale = lattice > 0 ? std::sqrt(steps / lattice) / step * 65536 : 0;
  return static_cast<uint32_t>(std::min(scale + 0.5, 4294967295.0));
}

}  // namespace

std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     double coarse_scale) {
  const size_t first = size_t(member) * frames.vertex_count, stride = size_t(frames.member_count) * frames.vertex_count;
  std::vector<glm::ivec3> positions = frames.positions;
  const bool coarse = coarse_scale > 0;
  const uint32_t base_scale = baseScale(&positions[first], mesh, coarse ? coarse_scale : 1);
  BinaryEncoder encoder;
  PositionModel model(encoder, mesh, base_scale);
  for (uint32_t f = 0; f < frames.frame_count; ++f) {
    glm::ivec3* frame = &positions[f * stride + first];
    if (!coarse)
      model.frame(frame);
    else
      model.frame(frame, [&](uint32_t v, const glm::ivec3& p) { return coarseResidual(frame[v], coarse_scale, p); });
  }
  ByteWriter out;
  out.u32(base_scale);
  out.bytes(encoder.take());
  return out.take();
}

}  // namespace fourdvt::package
