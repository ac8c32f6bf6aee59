// SPDX-License-Identifier: Apache-2.0
#include "render/picture_textures.h"

#include <cassert>

namespace fourdvt::render {

using Kind = PictureTextures::Kind;

Result<PictureTextures> createPicture(gpu::Device& device, int width, int height, Kind kind) {
  PictureTextures picture;
  picture.kind = kind;
  const auto plane = [&](gpu::Texture& out, gpu::PixelFormat format, int w, int h, const char* label) -> Status {
    FOURDVT_ASSIGN(out, gpu::makeTexture(device, {.format = format,
                                                  .width = w,
                                                  .height = h,
                                                  .filter = gpu::Filter::Linear,
                                                  .respecifiable = format == gpu::PixelFormat::RGBA8,
                                                  .label = label}));
    return {};
  };
  if (kind == Kind::Rgba) {
    FOURDVT_TRY(plane(picture.rgba, gpu::PixelFormat::RGBA8, width, height, "picture rgba"));
    return picture;
  }
  const bool pair = kind == Kind::Nv12;
  FOURDVT_TRY(plane(picture.y, gpu::PixelFormat::R8, width, height, "picture y"));
  FOURDVT_TRY(
      plane(picture.u, pair ? gpu::PixelFormat::RG8 : gpu::PixelFormat::R8, width / 2, height / 2, "picture u"));
  if (!pair) FOURDVT_TRY(plane(picture.v, gpu::PixelFormat::R8, width / 2, height / 2, "picture v"));
  return picture;
}

void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame, const gpu::Region& region) {
  assert(picture.kind == kindOf(frame));
  const int x = region.x / 2, y = region.y / 2;
  const gpu::Region half{x, y, (region.x + region.width + 1) / 2 - x, (region.y + region.height + 1) / 2 - y};
  const gpu::Region whole{2 * x, 2 * y, 2 * half.width, 2 * half.height};
  const auto plane = [&](const gpu::Texture& texture, const uint8_t* from, int stride, const gpu::Region& r,
                         int bytes) {
    device.updateTexture(texture.id(), r, from + ptrdiff_t{stride} * r.y + ptrdiff_t{bytes} * r.x, stride);
  };
  plane(picture.y, frame.y, frame.stride_y, whole, 1);
  plane(picture.u, frame.u, frame.stride_u, half, frame.v ? 1 : 2);
  if (frame.v) plane(picture.v, frame.v, frame.stride_v, half, 1);
}

void addPicture(std::vector<gpu::TextureBinding>& textures, const PictureTextures& picture) {
  if (picture.kind == Kind::Rgba) {
    textures.push_back({"u_picture_rgba", picture.rgba.id()});
    return;
  }
  textures.push_back({"u_picture_y", picture.y.id()});
  textures.push_back({"u_picture_u", picture.u.id()});
  if (picture.v) textures.push_back({"u_picture_v", picture.v.id()});
}

std::string definesOf(Kind kind) {
  return kind == Kind::Rgba ? "" : kind == Kind::I420 ? "PICTURE_YUV\n" : "PICTURE_YUV\nPICTURE_PAIR\n";
}

}  // namespace fourdvt::render
