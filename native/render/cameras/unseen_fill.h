// SPDX-License-Identifier: Apache-2.0
// Colours for the parts of a surface that no camera in use sees, from what lies round them on the surface: each vertex
// that is seen has its colour, the others are filled in by Laplace's equation between them, in a fixed number of steps
// on the GPU. Vertices that the steps do not reach stay unknown.
#pragma once

#include <array>
#include <map>
#include <string>

#include "render/cameras/camera_blend.h"
#include "render/fields/surface_neighbours.h"

namespace fourdvt::render {

class UnseenFill {
 public:
  static constexpr int kSteps =
      48;  // an unseen vertex gets a colour if one that is seen lies at most as many edges away

  // Fills the vertices' colours anew. Errors: GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model, size_t camera_count, const BlendPictures& pictures,
                const CameraUniforms& cameras);
  gpu::TextureId texture() const { return colors_[0].texture.id(); }  // a texel per vertex; alpha 0: unknown

 private:
  struct Table {
    gpu::Texture texture;
    gpu::Target target;
  };
  Status makeTables(gpu::Device& device, const CharacterModel& model);

  std::map<std::string, gpu::Program> seen_programs_;  // by their defines
  gpu::Program spread_program_;
  Table seen_;
  std::array<Table, 2> colors_;  // the result is in the first
  SurfaceNeighbours neighbours_;
  uint32_t table_vertices_ = 0;  // that the tables have room for
};

}  // namespace fourdvt::render
