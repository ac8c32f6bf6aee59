// SPDX-License-Identifier: Apache-2.0
// A decoded tiled picture in GPU textures. The caller decodes it and schedules uploads.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "gpu/device.h"

namespace fourdvt::render {

struct PictureTextures {
  // I420: three R8 planes. Nv12: R8 luma, and both chroma planes in one RG8 texture, as hardware decoders output them.
  // The shaders convert both by the BT.709 matrix. Rgba: one texture filled by the page from the browser's decoder.
  enum class Kind { I420, Nv12, Rgba } kind = Kind::I420;
  gpu::Texture y, u, v;  // u: both chroma planes in Nv12
  gpu::Texture rgba;
  bool made() const { return kind == Kind::Rgba ? bool(rgba) : y && u && (v || kind == Kind::Nv12); }
};

// Errors: GpuFailure.
Result<PictureTextures> createPicture(gpu::Device& device, int width, int height, PictureTextures::Kind kind);
// Returns the kind that matches the picture's planes.
inline PictureTextures::Kind kindOf(const I420View& picture) {
  return picture.v ? PictureTextures::Kind::I420 : PictureTextures::Kind::Nv12;
}
// Uploads the texels of `region`, and those that share a chroma texel with them; the frame must be of the picture's
// kind.
void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame, const gpu::Region& region);
inline void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame) {
  uploadPicture(device, picture, frame, {.width = frame.width, .height = frame.height});
}

// Textures and defines of programs that sample the picture (decoded_picture.glsl).
void addPicture(std::vector<gpu::TextureBinding>& textures, const PictureTextures& picture);
std::string definesOf(PictureTextures::Kind kind);

}  // namespace fourdvt::render
