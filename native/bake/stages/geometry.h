// SPDX-License-Identifier: Apache-2.0
// Frames of one GOP, quantised, as the package codes them; and the alignment that joins them later.
#pragma once

#include <span>

#include "bake/align/surface_alignment.h"
#include "bake/run/job.h"
#include "package/stream_file.h"

namespace fourdvt::bake {

// One frame, all in the decoded mesh's order.
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
  // Of what was added; the builder is empty again.
  package::ChunkFrames finish();

 private:
  void quantise(const Positions& positions, const glm::dvec3& origin, std::vector<glm::ivec3>& out) const;
  glm::dvec3 origin_;
  double step_m_;
  package::ChunkFrames empty_, frames_;
};

// Sets the frames' alignment; one entry a frame.
void addAlignment(std::span<const AlignedFrame> aligned, double step_m, package::ChunkFrames& frames);

}  // namespace fourdvt::bake
