// SPDX-License-Identifier: Apache-2.0
// Quantised positions and labels of one GOP → a stream chunk.
#pragma once

#include "bake/job.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::bake {

class ChunkBuilder {
 public:
  explicit ChunkBuilder(const Job& job);
  // Positions and labels in the decoded mesh's order; labels [layer][face].
  void add(const Positions& positions, const std::vector<uint8_t>& labels);
  // The chunk of what was added; the builder is empty again. Errors: Internal.
  Result<std::vector<uint8_t>> finish();

 private:
  glm::dvec3 origin_;
  double step_m_;
  package::ChunkMesh mesh_;
  package::ChunkFrames frames_;
};

}  // namespace fourdvt::bake
