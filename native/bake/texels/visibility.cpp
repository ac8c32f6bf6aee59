// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/visibility.h"

namespace fourdvt::bake {

Result<Visibility> Visibility::create(gpu::Device& device, const GpuCapture& capture) {
  Visibility v;
  v.rows_ = tableRows(capture.faceCount());
  FOURDVT_ASSIGN(auto program, gpu::makeProgram(device, "bake visibility", gpu::shaderText("fullscreen.vert"),
                                                gpu::shaderText("bake_visibility.frag"), kTableDefine));
  gpu::TextureDesc desc;
  desc.width = kTableWidth;
  desc.height = v.rows_ * static_cast<int>(capture.cameraCount());
  desc.label = "bake visibility";
  FOURDVT_ASSIGN(DrawnTexture drawn, makeDrawnTexture(device, desc));
  v.program_ = std::move(program);
  v.table_ = std::move(drawn.texture);
  v.target_ = std::move(drawn.target);
  return v;
}

Result<std::vector<float>> Visibility::measure(gpu::Device& device, const GpuCapture& capture) {
  const int cameras = static_cast<int>(capture.cameraCount()), faces = capture.faceCount();
  for (int c = 0; c < cameras; ++c) {
    gpu::Pass pass;
    pass.target = target_.id();
    pass.y = c * rows_;
    pass.width = kTableWidth;
    pass.height = rows_;
    pass.label = "bake visibility";
    device.beginPass(pass);
    gpu::Draw draw;
    draw.program = program_.id();
    capture.bindMesh(draw);
    capture.bindCamera(c, draw);
    const int first_row = c * rows_;
    draw.uniforms.push_back(gpu::uniform("first_row", first_row));
    draw.uniforms.push_back(gpu::uniform("face_count", faces));
    draw.vertex_count = 3;
    device.draw(draw);
    device.endPass();
  }
  const int height = rows_ * cameras;
  std::vector<uint8_t> pixels(static_cast<size_t>(kTableWidth) * height * 4);
  FOURDVT_TRY(device.readPixels(target_.id(), gpu::PixelFormat::RGBA8, {.width = kTableWidth, .height = height},
                                pixels.data()));
  std::vector<float> shares(static_cast<size_t>(cameras) * faces);
  for (int c = 0; c < cameras; ++c) {
    for (int f = 0; f < faces; ++f) {
      const int row_from_top = height - 1 - (c * rows_ + f / kTableWidth);
      shares[size_t(c) * faces + f] = pixels[(size_t(row_from_top) * kTableWidth + f % kTableWidth) * 4] / 255.0f;
    }
  }
  return shares;
}

}  // namespace fourdvt::bake
