// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/resample.h"

#include <algorithm>
#include <utility>

#include "package/character.h"

namespace fourdvt::bake {
namespace {

const char* filterDefine(ResampleFilter filter) {
  return filter == ResampleFilter::Bicubic ? "FILTER_BICUBIC 1\n" : "";
}

glm::mat4 affine(const ColourMap& map) {
  glm::mat4 m(map.matrix);
  m[3] = glm::vec4(map.offset, 1);
  return m;
}

}  // namespace

Result<Resampler> Resampler::create(gpu::Device& device, const GpuCapture& capture, const std::vector<int>& sizes,
                                    const ResampleOptions& options, const std::vector<ColourMap>& colour_maps) {
  if (!colour_maps.empty() && colour_maps.size() != capture.cameraCount())
    return Error{ErrorId::InvalidArgument, "resampling needs one colour map a camera, or none"};
  Resampler r;
  r.options_ = options;
  for (const ColourMap& map : colour_maps) r.colour_maps_.push_back(affine(map));
  r.colour_maps_.resize(capture.cameraCount(), glm::mat4(1));
  FOURDVT_ASSIGN(r.program_, gpu::makeProgram(device, "bake resample", gpu::shaderText("bake_resample.vert"),
                                              gpu::shaderText("bake_resample.frag"),
                                              std::string(kTableDefine) + filterDefine(options.filter)));
  gpu::TextureDesc desc;
  desc.format = gpu::PixelFormat::R32UI;
  desc.width = kTableWidth;
  desc.height = tableRows(sizes.size() * capture.faceCount());
  desc.label = "bake face list";
  FOURDVT_ASSIGN(r.face_list_, gpu::makeTexture(device, desc));
  for (int size : sizes) {
    desc.format = gpu::PixelFormat::RGBA8;
    desc.width = desc.height = size;
    desc.label = "bake layer";
    FOURDVT_ASSIGN(DrawnTexture drawn, makeDrawnTexture(device, desc));
    r.layers_.push_back({size, std::move(drawn.texture), std::move(drawn.target)});
  }
  return r;
}

Resampler::Batch Resampler::listFaces(const uint8_t* labels, size_t faces, size_t camera) {
  Batch batch;
  batch.camera = camera;
  batch.first = static_cast<int>(list_.size());
  for (size_t f = 0; f < faces; ++f)
    if (labels[f] == camera) list_.push_back(static_cast<uint32_t>(f));
  batch.count = static_cast<int>(list_.size()) - batch.first;
  return batch;
}

void Resampler::uploadList(gpu::Device& device) {
  const int rows = tableRows(list_.size());
  list_.resize(static_cast<size_t>(rows) * kTableWidth);
  device.updateTexture(face_list_.id(), {.width = kTableWidth, .height = rows}, list_.data());
}

void Resampler::drawBatches(gpu::Device& device, const GpuCapture& capture, const Layer& layer,
                            const std::vector<Batch>& batches) const {
  gpu::Pass pass;
  pass.target = layer.target.id();
  pass.width = pass.height = layer.size;
  pass.clear_color = true;
  pass.label = "bake resample";
  device.beginPass(pass);
  for (const Batch& batch : batches) {
    if (batch.count == 0) continue;
    gpu::Draw draw;
    draw.program = program_.id();
    capture.bindMesh(draw);
    capture.bindCamera(batch.camera, draw);
    draw.textures.push_back({"face_list", face_list_.id()});
    draw.uniforms.push_back(gpu::uniform("first_entry", batch.first));
    draw.uniforms.push_back(gpu::uniform("mark", batch.mark));
    draw.uniforms.push_back(gpu::uniform("colour_map", colour_maps_[batch.camera]));
    draw.uniforms.push_back(gpu::uniform("contour_pixels", options_.contour_pixels));
    draw.uniforms.push_back(gpu::uniform("contour_step", options_.contour_step_m));
    draw.uniforms.push_back(gpu::uniform("matte_threshold", options_.matte_threshold));
    draw.uniforms.push_back(gpu::uniform("matte_pixels", options_.matte_pixels));
    draw.vertex_count = 3 * batch.count;
    device.draw(draw);
  }
  device.endPass();
}

Result<Image> Resampler::readLayer(gpu::Device& device, const Layer& layer) const {
  Image image(layer.size, layer.size, 4);
  FOURDVT_TRY(device.readPixels(layer.target.id(), gpu::PixelFormat::RGBA8, {.width = layer.size, .height = layer.size},
                                image.pixels.data()));
  return image;
}

Result<std::vector<Image>> Resampler::resample(gpu::Device& device, const GpuCapture& capture,
                                               const std::vector<uint8_t>& labels) {
  const size_t faces = capture.faceCount();
  std::vector<std::vector<Batch>> batches(layers_.size());
  list_.clear();
  for (size_t l = 0; l < layers_.size(); ++l)
    for (size_t c = 0; c < capture.cameraCount(); ++c)
      batches[l].push_back(listFaces(labels.data() + l * faces, faces, c));
  uploadList(device);
  for (size_t l = 0; l < layers_.size(); ++l) drawBatches(device, capture, layers_[l], batches[l]);
  std::vector<Image> out;
  for (const Layer& layer : layers_) {
    FOURDVT_ASSIGN(auto image, readLayer(device, layer));
    out.push_back(std::move(image));
  }
  return out;
}

Result<std::vector<Image>> Resampler::resampleByRank(gpu::Device& device, const GpuCapture& capture, size_t l,
                                                     const std::vector<uint8_t>& order) {
  const Layer& layer = layers_[l];
  const size_t faces = capture.faceCount();
  std::vector<Image> out;
  for (size_t c = 0; c < capture.cameraCount(); ++c) {
    std::vector<Batch> batches;
    list_.clear();
    for (size_t rank = 0; rank * faces < order.size(); ++rank) {
      batches.push_back(listFaces(order.data() + rank * faces, faces, c));
      batches.back().mark = static_cast<float>(rank + 1) / 255;
    }
    uploadList(device);
    drawBatches(device, capture, layer, batches);
    FOURDVT_ASSIGN(auto image, readLayer(device, layer));
    out.push_back(std::move(image));
  }
  return out;
}

}  // namespace fourdvt::bake
