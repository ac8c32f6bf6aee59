// SPDX-License-Identifier: Apache-2.0
// What characters are composited with (4DVT step 6): a background picture, and meshes that hide them, catch their
// shadow or are seen themselves. Colours are sRGB-encoded, unlit, as the characters are.
#pragma once

#include <vector>

#include "gpu/device.h"
#include "package/character.h"

namespace fourdvt::render {

// Triangles in world coordinates.
struct SceneMesh {
  // RGBA32F table as CharacterModel's, 2 texels per corner: position; colour, straight alpha 1. Null: draws nothing.
  gpu::Texture corners;
  int corner_count = 0;
  bool occluder_only = false;  // writes depth only: the background picture shows what it is
};

struct SceneCorner {
  glm::vec3 position{0};  // world, metres
  glm::vec3 color{0.5f};
};
// Three corners per triangle; both sides are seen. Errors: InvalidArgument, GpuFailure.
Result<SceneMesh> makeSceneMesh(gpu::Device& device, std::span<const SceneCorner> corners, bool occluder_only);

struct Scene {
  // RGBA8, premultiplied, memory row 0 = top; stretched over the view, in place of RecipeOptions::background. 0: none.
  gpu::TextureId background = 0;
  // The faces of a box, of which only the inside is seen; without corners: none. Their colours are places in the
  // picture (x, y of 0…1 from the top left), which is RGBA8, memory row 0 = top, with mipmaps.
  SceneMesh room;
  gpu::Texture room_picture;
  std::vector<SceneMesh> meshes;
  float ground_y_m = 0;  // plane that receives the figures' contact shadows
};

// Sets the scene's room. The caller fills the picture, which has the size that the room says, and its mipmaps. Errors:
// GpuFailure, InvalidArgument.
Status setRoom(gpu::Device& device, const package::Room& room, Scene& scene);

}  // namespace fourdvt::render
