// SPDX-License-Identifier: Apache-2.0
// Pictures of the view's size for methods that render the view first, and the draw that shows one on the surface inside
// the caller's pass.
#pragma once

#include "render/character_model.h"
#include "render/view.h"

namespace fourdvt::render {

struct ViewPicture {
  gpu::Texture texture;
  gpu::Target target;
  int width = 0, height = 0;
};

// Remakes the picture unless it has this size. depth: Depth24 texture of this size used by the target; 0: none. Errors:
// GpuFailure.
Status resizeViewPicture(gpu::Device& device, int width, int height, const gpu::TextureDesc& like, gpu::TextureId depth,
                         ViewPicture& out);

class SurfacePicture {
 public:
  Status prepare(gpu::Device& device);  // makes the program. Errors: GpuFailure
  // picture: premultiplied, of the view's size, one sample a pixel, drawn y up.
  void draw(gpu::Device& device, const CharacterModel& model, const CharacterView& view, gpu::TextureId picture) const;

 private:
  gpu::Program program_;
};

}  // namespace fourdvt::render
