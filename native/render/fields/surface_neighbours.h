// SPDX-License-Identifier: Apache-2.0
// Which faces meet at each vertex of a model's surface, as a table for shaders. What the topology has not changed is
// kept. Used by what spreads values over the surface.
#pragma once

#include <vector>

#include "render/character_model.h"

namespace fourdvt::render {

class SurfaceNeighbours {
 public:
  // Errors: GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model);
  // R32UI: [vertex] where its list begins, and after the last the end; then the lists: the two other vertices of each
  // face at the vertex, in the face's order. A neighbour stands in a list once for each face that has both.
  gpu::TextureId texture() const { return table_.id(); }

 private:
  gpu::Texture table_;
  uint32_t vertices_ = 0, faces_ = 0;  // that the table has room for; 0: there is none
  uint64_t topology_serial_ = 0;
  bool is_filled_ = false;
  std::vector<uint32_t> lists_;  // scratch
};

}  // namespace fourdvt::render
