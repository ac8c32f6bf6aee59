// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/frame_baker.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

// Texel width in pixels from which layers are resampled with mipmaps.
constexpr double kMipmapTexelPixels = 2;

bool minifies(const std::vector<PinholeCamera>& cameras, const MeshTopology& t, const Positions& positions, int size) {
  double world_area = 0, uv_area = 0;
  for (uint32_t f = 0; f < t.faceCount(); ++f) {
    const glm::uvec3 v = t.face_vertices[f], w = t.face_uvs[f];
    const glm::dvec3 a(positions[v.x]);
    world_area += 0.5 * glm::length(glm::cross(glm::dvec3(positions[v.y]) - a, glm::dvec3(positions[v.z]) - a));
    const glm::dvec2 p(t.uvs[w.y] - t.uvs[w.x]), q(t.uvs[w.z] - t.uvs[w.x]);
    uv_area += 0.5 * std::abs(p.x * q.y - p.y * q.x);
  }
  const double texel_m = std::sqrt(world_area / std::max(uv_area, 1e-9)) / size;
  return std::any_of(cameras.begin(), cameras.end(), [&](const PinholeCamera& camera) {
    const double pixel_m = camera.project(glm::dvec3(positions[0])).z / camera.fx;
    return texel_m > kMipmapTexelPixels * std::abs(pixel_m);
  });
}

}  // namespace

Result<std::unique_ptr<FrameBaker>> FrameBaker::create(gpu::Device& device, const std::vector<PinholeCamera>& cameras,
                                                       const MeshTopology& topology, const Positions& pose,
                                                       const FrameBakerOptions& options) {
  auto baker = std::make_unique<FrameBaker>();
  baker->device_ = &device;
  const std::vector<int>& sizes = options.layer_sizes;
  const bool mipmaps = !sizes.empty() && (options.resample.filter == ResampleFilter::Mipmap ||
                                          minifies(cameras, topology, pose, sizes.back()));
  FOURDVT_ASSIGN(baker->capture_, GpuCapture::create(device, cameras, topology, mipmaps, options.length_scale));
  FOURDVT_ASSIGN(baker->visibility_, Visibility::create(device, baker->capture_));
  if (sizes.empty()) return baker;
  FOURDVT_ASSIGN(baker->resampler_,
                 Resampler::create(device, baker->capture_, sizes, options.resample, options.colour_maps));
  baker->large_map_ = makeGutterMap(topology, sizes[0], options.gutter_texels);
  if (sizes.back() != sizes[0])
    baker->small_map_ = makeGutterMap(topology, sizes.back(), options.gutter_texels * sizes.back() / sizes[0]);
  for (int size : sizes) baker->maps_.push_back(size == sizes[0] ? &baker->large_map_ : &baker->small_map_);
  return baker;
}

void FrameBaker::setFrame(const Positions& positions, const std::vector<PictureCrop>& crops) {
  capture_.setFrame(*device_, positions, crops);
}

Result<std::vector<float>> FrameBaker::measureVisibility() { return visibility_.measure(*device_, capture_); }

Result<std::vector<Image>> FrameBaker::resample(const std::vector<uint8_t>& labels) {
  return resampler_.resample(*device_, capture_, labels);
}

Result<std::vector<Image>> FrameBaker::resample(TexelRule rule, const std::vector<uint8_t>& order) {
  return rule(resampler_, *device_, capture_, order);
}

void FrameBaker::fill(std::vector<Image>& layers) const { fillLayers(maps_, layers); }

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
