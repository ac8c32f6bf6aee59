// SPDX-License-Identifier: Apache-2.0
// A decoded tiled picture on the GPU. Does NOT decode and does NOT decide what is uploaded when.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "gpu/device.h"

namespace fourdvt::render {

struct PictureTextures {
  // Planes are converted by the shaders' own BT.709 matrix: R8 each, or with both chroma planes in one RG8 texture, as
  // decoders in hardware give them. Rgba: one texture that the page fills from what its browser decoded.
  enum class Kind { I420, Nv12, Rgba } kind = Kind::I420;
  gpu::Texture y, u, v;  // u: both chroma planes of Nv12
  gpu::Texture rgba;
  bool made() const { return kind == Kind::Rgba ? bool(rgba) : y && u && (v || kind == Kind::Nv12); }
};

// Errors: GpuFailure.
Result<PictureTextures> createPicture(gpu::Device& device, int width, int height, PictureTextures::Kind kind);
// The kind that the planes of the picture make.
inline PictureTextures::Kind kindOf(const I420View& picture) {
  return picture.v ? PictureTextures::Kind::I420 : PictureTextures::Kind::Nv12;
}
// Uploads a part of a picture of this kind: the texels of `region`, and those that share a chroma texel with them.
void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame, const gpu::Region& region);
inline void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame) {
  uploadPicture(device, picture, frame, {.width = frame.width, .height = frame.height});
}

// Textures and defines with which a program reads such a picture (decoded_picture.glsl).
void addPicture(std::vector<gpu::TextureBinding>& textures, const PictureTextures& picture);
std::string definesOf(PictureTextures::Kind kind);

}  // namespace fourdvt::render
