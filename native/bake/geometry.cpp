// SPDX-License-Identifier: Apache-2.0
#include "bake/geometry.h"

#include <cmath>

namespace fourdvt::bake {

ChunkBuilder::ChunkBuilder(const Job& job)
    : origin_(job.bounds.min),
      step_m_(double(float(job.options.position_step_m))),
      mesh_(package::makeChunkMesh(job.mesh.decoded)) {
  frames_.vertex_count = job.mesh.decoded.topology.vertex_count;
  frames_.face_count = job.mesh.decoded.topology.faceCount();
  frames_.layer_count = static_cast<uint32_t>(job.options.layers);
}

void ChunkBuilder::add(const Positions& positions, const std::vector<uint8_t>& labels) {
  for (const glm::vec3& p : positions) {
    const glm::dvec3 q = glm::round((glm::dvec3(p) - origin_) / step_m_);
    frames_.positions.emplace_back(q);
  }
  frames_.labels.insert(frames_.labels.end(), labels.begin(), labels.end());
  ++frames_.frame_count;
}

Result<std::vector<uint8_t>> ChunkBuilder::finish() {
  auto chunk = package::encodeChunk(frames_, mesh_);
  frames_.positions.clear();
  frames_.labels.clear();
  frames_.frame_count = 0;
  return chunk;
}

}  // namespace fourdvt::bake
