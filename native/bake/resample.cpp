// SPDX-License-Identifier: Apache-2.0
#include "bake/resample.h"

#include "package/character.h"

namespace fourdvt::bake {

Result<Resampler> Resampler::create(gpu::Device& device, const GpuCapture& capture, const std::vector<int>& sizes) {
  Resampler r;
  auto program = gpu::makeProgram(device, "bake resample", gpu::shaderSource("bake_resample.vert"),
                                  gpu::shaderSource("bake_resample.frag"), kTableDefine);
  if (!program) return program.error();
  r.program_ = program.take();
  gpu::TextureDesc desc;
  desc.format = gpu::PixelFormat::R32UI;
  desc.width = kTableWidth;
  desc.height = tableRows(sizes.size() * capture.faceCount());
  desc.label = "bake face list";
  auto list = gpu::makeTexture(device, desc);
  if (!list) return list.error();
  r.face_list_ = list.take();
  for (int size : sizes) {
    desc.format = gpu::PixelFormat::RGBA8;
    desc.width = desc.height = size;
    desc.label = "bake layer";
    auto texture = gpu::makeTexture(device, desc);
    if (!texture) return texture.error();
    gpu::TargetDesc target_desc;
    target_desc.colors = {texture.value().id()};
    target_desc.label = "bake layer";
    auto target = gpu::makeTarget(device, target_desc);
    if (!target) return target.error();
    r.layers_.push_back({size, texture.take(), target.take()});
  }
  return r;
}

std::vector<Resampler::Batch> Resampler::listFaces(gpu::Device& device, const std::vector<uint8_t>& labels,
                                                   size_t cameras, size_t faces) {
  std::vector<Batch> batches(layers_.size() * cameras);
  list_.clear();
  for (size_t l = 0; l < layers_.size(); ++l) {
    for (size_t c = 0; c < cameras; ++c) {
      Batch& batch = batches[l * cameras + c];
      batch.first = static_cast<int>(list_.size());
      for (size_t f = 0; f < faces; ++f)
        if (labels[l * faces + f] == c) list_.push_back(static_cast<uint32_t>(f));
      batch.count = static_cast<int>(list_.size()) - batch.first;
    }
  }
  const int rows = tableRows(list_.size());
  list_.resize(static_cast<size_t>(rows) * kTableWidth);
  device.updateTexture(face_list_.id(), 0, 0, 0, kTableWidth, rows, list_.data());
  return batches;
}

Result<std::vector<Image>> Resampler::resample(gpu::Device& device, const GpuCapture& capture,
                                               const std::vector<uint8_t>& labels) {
  const size_t cameras = capture.cameraCount();
  const std::vector<Batch> batches = listFaces(device, labels, cameras, capture.faceCount());
  std::vector<Image> out;
  for (size_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    gpu::Pass pass;
    pass.target = layer.target.id();
    pass.width = pass.height = layer.size;
    pass.clear_color = true;
    pass.label = "bake resample";
    device.beginPass(pass);
    for (size_t c = 0; c < cameras; ++c) {
      const Batch& batch = batches[l * cameras + c];
      if (batch.count == 0) continue;
      gpu::Draw draw;
      draw.program = program_.id();
      capture.bindMesh(draw);
      capture.bindCamera(c, draw);
      draw.textures.push_back({"face_list", face_list_.id()});
      draw.uniforms.push_back(gpu::uniform("first_entry", batch.first));
      draw.vertex_count = 3 * batch.count;
      device.draw(draw);
    }
    device.endPass();
  }
  for (const Layer& layer : layers_) {
    Image image(layer.size, layer.size, 4);
    FOURDVT_TRY(device.readPixels(layer.target.id(), gpu::PixelFormat::RGBA8, 0, 0, layer.size, layer.size,
                                  image.pixels.data()));
    out.push_back(std::move(image));
  }
  return out;
}

}  // namespace fourdvt::bake
