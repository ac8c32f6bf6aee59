// SPDX-License-Identifier: Apache-2.0
// State shared by draws with camera_blend.glsl: the cameras, their centres, pictures and depth maps; and colours for
// surface that no camera sees. Pictures and programs are borrowed.
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

// Maximum cameras of one draw: WebGL2 guarantees 224 uniform vectors.
constexpr int kMaxBlendedCameras = 20;

// Returns the `closest` cameras (0: all) whose directions are nearest in angle to the view's axis, nearest first. A
// camera's direction is the ray through the middle of its picture, which a shifted lens turns off the optical axis.
std::vector<size_t> camerasTowards(std::span<const PinholeCamera> cameras, const glm::vec3& view_axis, int closest);

// Camera pictures: layers of an array texture, indexed by camera, or tiles of a decoded picture.
struct BlendPictures {
  gpu::TextureId array = 0;
  const CameraLook* tiled = nullptr;
  glm::vec2 size{1};  // texels of a layer, or of the decoded picture
};

// Uniforms of one draw; must outlive it.
class CameraUniforms {
 public:
  // Requires up-to-date depth maps of the chosen cameras. length_scale: the model's. An out-of-range camera index
  // stands for a camera that sees nothing; at least one index is valid.
  CameraUniforms(std::span<const PinholeCamera> cameras, std::span<const size_t> chosen, const DepthMaps& maps,
                 const BlendPictures& pictures, float min_cosine, float length_scale);
  void addTo(gpu::Draw& draw) const;
  // Returns the defines of programs that draw with these uniforms.
  static std::string defines(size_t camera_count, const BlendPictures& pictures);

 private:
  const DepthMaps& maps_;
  const BlendPictures pictures_;
  float min_cosine_, depth_bias_, reach_;
  int depth_rows_;
  std::vector<glm::mat4> pixel_from_character_;
  std::vector<glm::vec4> centres_, pixel_spans_, sizes_near_far_, sources_, tiles_;
};

// Fills the surface that no camera in use sees with colours from the surface nearby: seen vertices keep their colours,
// the others are interpolated by Laplace's equation in a fixed number of Jacobi steps on the GPU. Vertices beyond the
// steps' reach stay unknown.
class UnseenFill {
 public:
  static constexpr int kSteps = 48;  // maximum edges from an unseen vertex to a seen one

  // Recomputes the vertex colours. Errors: GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model, size_t camera_count, const BlendPictures& pictures,
                const CameraUniforms& cameras);
  gpu::TextureId texture() const { return colors_[0].texture.id(); }  // a texel per vertex; alpha 0: unknown

 private:
  struct Table {
    gpu::Texture texture;
    gpu::Target target;
  };
  Status makeTables(gpu::Device& device, const CharacterModel& model);

  std::map<std::string, gpu::Program> seen_programs_;  // keyed by defines
  gpu::Program spread_program_;
  Table seen_;
  std::array<Table, 2> colors_;  // the result is in the first
  SurfaceNeighbours neighbours_;
  uint32_t table_vertices_ = 0;  // capacity of the tables
};

}  // namespace fourdvt::render
