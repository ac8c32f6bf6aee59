// SPDX-License-Identifier: Apache-2.0
#include "bake/run/geometry.h"

#include <cmath>
#include <utility>

#include "bake/run/renditions.h"

namespace fourdvt::bake {

ChunkBuilder::ChunkBuilder(const Job& job, const StreamPlan& plan)
    : origin_(job.bounds.min), step_m_(double(float(*job.options.position_step_m))) {
  empty_.vertex_count = job.mesh.decoded.topology.vertex_count;
  empty_.face_count = job.mesh.decoded.topology.faceCount();
  empty_.layer_count = static_cast<uint32_t>(job.options.layers);
  empty_.member_count = static_cast<uint32_t>(plan.motion.members.size());
  empty_.reference_count = static_cast<uint32_t>(plan.motion.reference_weights.size());
  frames_ = empty_;
}

void ChunkBuilder::quantise(const Positions& positions, const glm::dvec3& origin, std::vector<glm::ivec3>& out) const {
  for (const glm::vec3& p : positions) out.emplace_back(gridPlace(p, origin, step_m_));
}

void ChunkBuilder::add(const FrameGeometry& geometry, const std::vector<uint8_t>& labels) {
  for (const Positions& member : geometry.members) quantise(member, origin_, frames_.positions);
  for (const Positions& offset : geometry.offsets) quantise(offset, glm::dvec3(0), frames_.offsets);
  frames_.labels.insert(frames_.labels.end(), labels.begin(), labels.end());
  frames_.root.insert(frames_.root.end(), geometry.root.begin(), geometry.root.end());
  ++frames_.frame_count;
}

package::ChunkFrames ChunkBuilder::finish() { return std::exchange(frames_, empty_); }

Status saveChunks(const BakeRun& run, const StreamPlan& plan, uint32_t gop, const package::ChunkFrames& frames,
                  const package::ChunkMesh& mesh) {
  const BakeOptions& o = run.job.options;
  if (hasCoarseGeometry(o)) {
    FOURDVT_ASSIGN(const auto coarse, package::encodeCoarseChunk(frames, mesh, *o.coarse_step_m / *o.position_step_m));
    FOURDVT_TRY(run.work.saveChunk(plan.name, gop, coarse, Precision::Coarse));
  }
  FOURDVT_ASSIGN(const auto chunk, package::encodeChunk(frames, mesh));
  return run.work.saveChunk(plan.name, gop, chunk);
}

}  // namespace fourdvt::bake
