// SPDX-License-Identifier: Apache-2.0
// GPU resources of one captured frame, shared by visibility and resampling: the mesh as tables, and per camera the
// picture and the mesh's depth map.
#pragma once

#include <vector>

#include "bake/texels/picture_crop.h"
#include "base/camera.h"
#include "base/mesh.h"
#include "gpu/device.h"

namespace fourdvt::bake {

// Texels per row of table textures: wide, since visibility has the rows of all faces once for each camera.
constexpr int kTableWidth = 2048;
constexpr const char* kTableDefine = "TABLE_WIDTH 2048\n";
// Bias of the depth test for a person's surface, on top of the depth range that its slope spans within one pixel.
constexpr float kDepthBias_m = 0.004f;
constexpr float kMinCosine = 0.2f;  // between normal and ray; below, depths vary too much within a pixel to be tested

class GpuCapture {
 public:
  // `mipmaps`: for pictures that smaller layers minify. `length_scale`: metres per metre of a scene in which the
  // surface has a person's size. Errors: GpuFailure.
  static Result<GpuCapture> create(gpu::Device& device, const std::vector<PinholeCamera>& cameras,
                                   const MeshTopology& topology, bool mipmaps, float length_scale = 1);
  // Uploads the frame and renders all depth maps.
  void setFrame(gpu::Device& device, const Positions& positions, const std::vector<PictureCrop>& crops);

  size_t cameraCount() const { return cameras_.size(); }
  int faceCount() const { return face_count_; }
  // Appends the textures and uniforms that bake_mesh.glsl and bake_camera.glsl declare, for camera c. They are borrowed
  // until the next call.
  void bindMesh(gpu::Draw& draw) const;
  void bindCamera(size_t c, gpu::Draw& draw) const;

 private:
  struct Camera {
    PinholeCamera pinhole;
    gpu::Texture picture, depth;
    gpu::Target target;
    glm::mat4 cam_from_world{1}, clip_from_world{1};
    glm::vec4 intrinsics{0}, size_near_far{0};
    PictureRegion uploaded;  // uploaded part of the picture; with mipmaps, the rest is clear
  };
  void uploadPicture(gpu::Device& device, Camera& camera, const PictureCrop& crop);

  std::vector<Camera> cameras_;
  gpu::Texture corners_, positions_;
  gpu::Program depth_program_;
  int face_count_ = 0, vertex_count_ = 0;
  bool mipmaps_ = false;
  float depth_bias_m_ = kDepthBias_m;
  std::vector<glm::vec4> scratch_;
  std::vector<uint8_t> clear_;
};

// Uploads `values` (padded to whole rows) into a table texture.
void updateTable(gpu::Device& device, gpu::TextureId table, std::vector<glm::vec4>& values);
inline int tableRows(size_t count) { return count ? static_cast<int>((count + kTableWidth - 1) / kTableWidth) : 1; }

// A texture with its render target.
struct DrawnTexture {
  gpu::Texture texture;
  gpu::Target target;
};
// Both carry the label of `desc`. Errors: GpuFailure.
Result<DrawnTexture> makeDrawnTexture(gpu::Device& device, const gpu::TextureDesc& desc);

}  // namespace fourdvt::bake
