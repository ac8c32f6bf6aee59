// SPDX-License-Identifier: Apache-2.0
// Depth maps of a surface from its cameras, for the visibility test of fragments: one map per camera in use, redrawn
// only when the surface changes. Offset multi-draw (LVDT 2, step 2): the mesh is drawn into a camera's depth buffer
// five times, unmoved and moved by one texel along the four diagonals, which dilates occluders by a texel and keeps
// their texture off the surface beside their outline. The depth test's bias grows with the slope by the same amount,
// against self-occlusion.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"
#include "render/method.h"

namespace fourdvt::render {

struct DepthMapOptions {
  Visibility visibility = Visibility::Offset;
  double texels_per_pixel = 1;  // along each side of a camera's picture, at most 4
  double line_texels = 3;       // width of the lines of fattened maps
};

class DepthMaps {
 public:
  // layers: maps held at a time, at least 1. Errors: GpuFailure, InvalidArgument.
  static Result<DepthMaps> create(gpu::Device& device, std::span<const PinholeCamera> cameras, int layers,
                                  const DepthMapOptions& options);
  // Draws the outdated maps of these cameras, at most one per layer, for `model`. regions: picture regions of its
  // surface, one per camera; cameras with an empty region are skipped. Returns the number of maps drawn.
  int update(gpu::Device& device, const CharacterModel& model, std::span<const size_t> cameras,
             std::span<const PictureRegion> regions);

  void forget();  // makes the next update draw all maps again

  gpu::TextureId texture() const { return texture_.id(); }  // Depth24 array
  int rows() const { return height_; }                      // rows of a layer
  int layerOf(size_t camera) const { return cameras_[camera].layer; }
  glm::vec2 texelsPerPixel(size_t camera) const;
  // Slope-scaled bias of the depth test, map texels; negative: no test.
  float reach() const;
  // Near and far plane of the camera's map, metres.
  glm::vec2 nearFar(size_t camera) const { return {cameras_[camera].region.near_m, cameras_[camera].region.far_m}; }

 private:
  struct Camera {
    PinholeCamera pinhole;
    PictureRegion region;       // picture region in the map
    int columns = 0, rows = 0;  // texels of the map for the whole picture
    int layer = -1;             // -1: none
    uint64_t serial = 0;        // surface in the map
  };
  void place(std::span<const size_t> cameras);
  void drawMap(gpu::Device& device, const CharacterModel& model, const Camera& camera) const;
  void drawEdges(gpu::Device& device, const CharacterModel& model, const Camera& camera,
                 const glm::mat4& clip_from_character, const glm::vec2& clip_per_texel) const;

  DepthMapOptions options_;
  std::vector<Camera> cameras_;
  std::vector<gpu::Target> targets_;  // indexed by layer
  gpu::Texture texture_;
  gpu::Program depth_program_, edges_program_;
  int height_ = 0;
};

// Returns a draw with the surface's tables and state for a program of this folder; vertices are pulled by
// character_vertex.glsl.
gpu::Draw surfaceDraw(const CharacterModel& model, gpu::ProgramId program);
// Makes a program of this folder's shaders. Errors: GpuFailure.
Result<gpu::Program> makeCameraProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                       const std::string& defines = {});

}  // namespace fourdvt::render
