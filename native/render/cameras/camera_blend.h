// SPDX-License-Identifier: Apache-2.0
// What draws with camera_blend.glsl have in common: which cameras, where they are, where their pictures and depth maps
// lie. Does NOT own pictures or programs.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "render/cameras/depth_maps.h"
#include "render/fields/surface_fields.h"
#include "render/method.h"

namespace fourdvt::render {

// How many cameras one draw blends at most: WebGL2 promises 224 uniform vectors.
constexpr int kMaxBlendedCameras = 20;

// The `closest` cameras whose rays through their pictures' middles, which shifted lenses turn off their optical axes,
// are nearest in angle to the view's axis, nearest first; 0: all.
std::vector<size_t> camerasTowards(std::span<const PinholeCamera> cameras, const glm::vec3& view_axis, int closest);

// The cameras' pictures: layers of an array texture, by the cameras' numbers, or tiles of a decoded picture.
struct BlendPictures {
  gpu::TextureId array = 0;
  const CameraLook* tiled = nullptr;
  glm::vec2 size{1};  // texels of a layer, or of the decoded picture
};

// The uniforms of one draw; keep it until the draw is made.
class CameraUniforms {
 public:
  // The depth maps of the chosen cameras are up to date. length_scale: the model's. A number that is no camera's stands
  // for one that sees nothing; not all are such.
  CameraUniforms(std::span<const PinholeCamera> cameras, std::span<const size_t> chosen, const DepthMaps& maps,
                 const BlendPictures& pictures, float least_cosine, float length_scale);
  void addTo(gpu::Draw& draw) const;
  // What a program that makes such draws is made with.
  static std::string defines(size_t camera_count, const BlendPictures& pictures);

 private:
  const DepthMaps& maps_;
  const BlendPictures pictures_;
  float least_cosine_, depth_bias_, reach_;
  int depth_rows_;
  std::vector<glm::mat4> pixel_from_character_;
  std::vector<glm::vec4> centres_, pixel_spans_, sizes_near_far_, sources_, tiles_;
};

// Colours for the parts of a surface that no camera in use sees, from what lies round them on the surface: each vertex
// that is seen has its colour, the others are filled in by Laplace's equation between them, in a fixed number of steps
// on the GPU. Vertices that the steps do not reach stay unknown.
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
