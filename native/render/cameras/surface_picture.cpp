// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/surface_picture.h"

#include "render/cameras/depth_maps.h"

namespace fourdvt::render {

Status resizeViewPicture(gpu::Device& device, int width, int height, const gpu::TextureDesc& like, gpu::TextureId depth,
                         ViewPicture& out) {
  if (out.width == width && out.height == height) return {};
  out = {};
  gpu::TextureDesc desc = like;
  desc.width = width;
  desc.height = height;
  FOURDVT_ASSIGN(out.texture, gpu::makeTexture(device, desc));
  FOURDVT_ASSIGN(out.target,
                 gpu::makeTarget(device, {.colors = {out.texture.id()}, .depth = depth, .label = like.label}));
  out.width = width;
  out.height = height;
  return {};
}

Status SurfacePicture::prepare(gpu::Device& device) {
  if (program_) return {};
  FOURDVT_ASSIGN(program_, makeCameraProgram(device, "camera_surface.vert", "camera_picture.frag"));
  return {};
}

void SurfacePicture::draw(gpu::Device& device, const CharacterModel& model, const CharacterView& view,
                          gpu::TextureId picture) const {
  gpu::Draw draw = surfaceDraw(model, program_.id());
  draw.textures.push_back({"u_shown", picture});
  draw.uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character),
                   gpu::uniform("u_origin", view.origin)};
  device.draw(draw);
}

}  // namespace fourdvt::render
