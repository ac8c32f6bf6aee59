// SPDX-License-Identifier: Apache-2.0
// Draws an actor's surface, multisampled. Borrows the device, which must outlive it.
#pragma once

#include "base/camera.h"
#include "base/image.h"
#include "gpu/device.h"
#include "lab/studio/actors/actor.h"

namespace fourdvt::studio {

struct Shading {
  float wrinkles = 0, specular = 0, shading = 0;  // see StudioKnobs
};

class Renderer {
 public:
  // Fixes the size of all pictures. Errors: GpuFailure.
  static Result<Renderer> create(gpu::Device& device, const RestMesh& surface, const Image& texture, int width,
                                 int height);
  // Sets the pose. Cloth folds depend on `place`, 0…1 from the first motion to the last, and on `phase`, 0…1.
  void setPose(const Positions& positions, double place, double phase);
  // Returns RGBA, premultiplied, on a transparent background.
  Result<Image> draw(const PinholeCamera& camera, double near_m, double far_m, const Shading& shading);

 private:
  explicit Renderer(gpu::Device& device) : device_(&device) {}
  Status makeTables(const RestMesh& surface);
  Status makeTargets(int width, int height);
  Result<gpu::Texture> table(size_t count, const char* label);
  void update(const gpu::Texture& table, std::span<const glm::vec3> values);

  gpu::Device* device_;
  gpu::Program program_;
  gpu::Texture albedo_, corners_, rest_, positions_, normals_, resolved_;
  gpu::Target samples_, picture_;
  std::vector<glm::uvec3> faces_;
  std::vector<glm::vec4> scratch_;
  std::vector<glm::vec3> normal_scratch_;
  glm::vec2 motion_{0};
  int width_ = 0, height_ = 0;
};

}  // namespace fourdvt::studio
