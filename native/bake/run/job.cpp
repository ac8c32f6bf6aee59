// SPDX-License-Identifier: Apache-2.0
#include "bake/run/job.h"

#include <cmath>

namespace fourdvt::bake {

uint32_t StreamPlan::sourceFrame(size_t member, uint32_t frame) const {
  const ClassMember& m = motion.members[member];
  return static_cast<uint32_t>(std::llround(m.source_frame[frame])) % m.source->frame_count;
}

uint32_t Job::streamFrames() const {
  uint32_t sum = 0;
  for (const StreamPlan& stream : streams) sum += stream.frameCount();
  return sum;
}

Positions reordered(const package::EncodedBaseMesh& mesh, const Positions& source) {
  Positions out;
  out.reserve(mesh.source_vertex.size());
  for (uint32_t v : mesh.source_vertex) out.push_back(source[v]);
  return out;
}

}  // namespace fourdvt::bake
