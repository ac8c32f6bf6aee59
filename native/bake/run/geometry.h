// SPDX-License-Identifier: Apache-2.0
// Quantises the frames of one GOP as the package codes them, and codes them.
#pragma once

#include "bake/run/bake_run.h"
#include "package/stream_file.h"

namespace fourdvt::bake {

// Whole steps from the origin to the place of the grid that a point is streamed at.
inline glm::dvec3 gridPlace(const glm::vec3& point, const glm::dvec3& origin, double step_m) {
  return glm::round((glm::dvec3(point) - origin) / step_m);
}

// The meshes of one frame, in the decoded mesh's order.
struct FrameGeometry {
  std::vector<Positions> members;  // [member]
  std::vector<Positions> offsets;  // [reference]: corrections of the mesh blend
  std::vector<glm::vec3> root;     // [member]
};

class ChunkBuilder {
 public:
  ChunkBuilder(const Job& job, const StreamPlan& plan);
  // labels: [member][layer][face].
  void add(const FrameGeometry& geometry, const std::vector<uint8_t>& labels);
  // The frames that were added; the builder is empty afterwards.
  package::ChunkFrames finish();

 private:
  void quantise(const Positions& positions, const glm::dvec3& origin, std::vector<glm::ivec3>& out) const;
  glm::dvec3 origin_;
  double step_m_;
  package::ChunkFrames empty_, frames_;
};

// Codes a GOP's frames into the work folder: coarsely too if a rendition goes with that, and last as they are. Errors:
// WriteFailed, Internal.
Status saveChunks(const BakeRun& run, const StreamPlan& plan, uint32_t gop, const package::ChunkFrames& frames,
                  const package::ChunkMesh& mesh);

}  // namespace fourdvt::bake
