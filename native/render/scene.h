// SPDX-License-Identifier: Apache-2.0
// Scene that characters are composited with (4DVT step 6): a background picture, and meshes that occlude the
// characters, receive their shadow or are visible themselves. Colours are sRGB-encoded and unlit, like the characters'.
#pragma once

#include <vector>

#include "gpu/device.h"
#include "package/character.h"

namespace fourdvt::render {

// Triangles in world coordinates.
struct SceneMesh {
  // RGBA32F table in CharacterModel's addressing, 2 texels per corner: position; colour, straight alpha 1. Null: empty
  // mesh.
  gpu::Texture corners;
  int corner_count = 0;
  bool occluder_only = false;  // writes depth only; the background picture shows the object
};

struct SceneCorner {
  glm::vec3 position{0};  // world, metres
  glm::vec3 color{0.5f};
};
// Makes a two-sided mesh of three corners per triangle. Errors: InvalidArgument, GpuFailure.
Result<SceneMesh> makeSceneMesh(gpu::Device& device, std::span<const SceneCorner> corners, bool occluder_only);

struct Scene {
  // RGBA8, premultiplied, memory row 0 = top; stretched over the view in place of RecipeOptions::background. 0: no
  // picture.
  gpu::TextureId background = 0;
  // Box seen from inside; disabled without corners. Corner colours are texture coordinates in the picture (0…1 from the
  // top left), which is RGBA8, memory row 0 = top, with mipmaps.
  SceneMesh room;
  gpu::Texture room_picture;
  std::vector<SceneMesh> meshes;
  float ground_y_m = 0;  // plane that receives the figures' contact shadows
};

// Sets the scene's room and allocates its picture at the room's picture size. The caller fills the picture and its
// mipmaps. Errors: GpuFailure, InvalidArgument.
Status setRoom(gpu::Device& device, const package::Room& room, Scene& scene);

}  // namespace fourdvt::render
