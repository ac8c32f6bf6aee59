// SPDX-License-Identifier: Apache-2.0
// Depth maps of a surface as its cameras see it: by them a fragment knows which cameras see it. A map is drawn again
// only when the surface changes. There are as many as cameras are used at a time, not as there are cameras.
// Offset multi-draw (LVDT 2, step 2) is read as: the mesh goes into a camera's depth buffer five times, unmoved and
// moved by one texel along the four diagonals, so that occluders grow by a texel and a surface beside their outline is
// not textured from them; the depth test's tolerance grows with the slope by as much, so that nothing hides itself.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"
#include "render/method.h"

namespace fourdvt::render {

struct DepthMapOptions {
  Visibility visibility = Visibility::Offset;
  double texels_per_pixel = 1;  // along each side of a camera's picture, up to 4
  double line_texels = 3;       // width of the lines of fattened maps
};

class DepthMaps {
 public:
  // `layers`: how many maps are held at a time, at least 1. Errors: GpuFailure, InvalidArgument.
  static Result<DepthMaps> create(gpu::Device& device, std::span<const PinholeCamera> cameras, int layers,
                                  const DepthMapOptions& options);
  // From now on `model` is seen, whose surface lies within `regions`, one per camera; empty ones are not drawn.
  // Draws the maps of these cameras, at most as many as there are layers, that are not those of this surface yet.
  // Returns how many were drawn.
  int update(gpu::Device& device, const CharacterModel& model, std::span<const size_t> cameras,
             std::span<const PictureRegion> regions);

  void forget();  // the next update draws all maps again

  gpu::TextureId texture() const { return texture_.id(); }  // Depth24 array
  int rows() const { return height_; }                      // of a layer
  int layerOf(size_t camera) const { return cameras_[camera].layer; }
  glm::vec2 texelsPerPixel(size_t camera) const;
  // Texels that a map's depth may be off by, for the depth test; negative: there is none.
  float reach() const;
  // Near and far plane of the camera's map, metres.
  glm::vec2 nearFar(size_t camera) const { return {cameras_[camera].region.near_m, cameras_[camera].region.far_m}; }

 private:
  struct Camera {
    PinholeCamera pinhole;
    PictureRegion region;       // of the surface that the map shows
    int columns = 0, rows = 0;  // texels of the map for the whole picture
    int layer = -1;             // none is held
    uint64_t serial = 0;        // of the surface that the map shows
  };
  void place(std::span<const size_t> cameras);
  void drawMap(gpu::Device& device, const CharacterModel& model, const Camera& camera) const;
  void drawEdges(gpu::Device& device, const CharacterModel& model, const Camera& camera,
                 const glm::mat4& clip_from_character, const glm::vec2& clip_per_texel) const;

  DepthMapOptions options_;
  std::vector<Camera> cameras_;
  std::vector<gpu::Target> targets_;  // by layer
  gpu::Texture texture_;
  gpu::Program depth_program_, edges_program_;
  int height_ = 0;
};

// The surface's tables and state for a draw of a program of this folder; vertices pulled by character_vertex.glsl.
gpu::Draw surfaceDraw(const CharacterModel& model, gpu::ProgramId program);
// A program of this folder's shaders. Errors: GpuFailure.
Result<gpu::Program> makeCameraProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                       const std::string& defines = {});

}  // namespace fourdvt::render
