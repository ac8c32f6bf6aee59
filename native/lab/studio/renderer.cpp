// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/renderer.h"

#include <algorithm>

namespace fourdvt::studio {
namespace {

constexpr int kTableWidth = 1024, kMultisamples = 4;
constexpr const char* kDefines = "TABLE_WIDTH 1024\n";

Image withAlpha(const Image& rgb) {
  Image out(rgb.width, rgb.height, 4, 255);
  for (size_t i = 0; i < size_t(rgb.width) * rgb.height; ++i) std::copy_n(&rgb.pixels[3 * i], 3, &out.pixels[4 * i]);
  return out;
}

}  // namespace

Result<Renderer> Renderer::create(gpu::Device& device, const RestMesh& surface, const Image& texture, int width,
                                  int height) {
  Renderer renderer(device);
  renderer.width_ = width;
  renderer.height_ = height;
  renderer.faces_ = surface.topology.face_vertices;
  FOURDVT_ASSIGN(renderer.program_, gpu::makeProgram(device, "studio surface", gpu::shaderText("studio_surface.vert"),
                                                     gpu::shaderText("studio_surface.frag"), kDefines));
  FOURDVT_ASSIGN(renderer.albedo_, gpu::makeTexture(device, {.width = texture.width,
                                                             .height = texture.height,
                                                             .filter = gpu::Filter::LinearMipmap,
                                                             .label = "studio albedo"}));
  const Image rgba = texture.channels == 4 ? texture : withAlpha(texture);
  device.updateTexture(renderer.albedo_.id(), {.width = rgba.width, .height = rgba.height}, rgba.pixels.data());
  device.generateMipmaps(renderer.albedo_.id());
  FOURDVT_TRY(renderer.makeTables(surface));
  FOURDVT_TRY(renderer.makeTargets(width, height));
  return renderer;
}

Result<gpu::Texture> Renderer::table(size_t count, const char* label) {
  return gpu::makeTexture(*device_, {.format = gpu::PixelFormat::RGBA32F,
                                     .width = kTableWidth,
                                     .height = static_cast<int>((count + kTableWidth - 1) / kTableWidth),
                                     .label = label});
}

Status Renderer::makeTables(const RestMesh& surface) {
  const size_t vertices = surface.positions.size();
  const std::pair<gpu::Texture*, size_t> tables[] = {
      {&corners_, 3 * faces_.size()}, {&rest_, vertices}, {&positions_, vertices}, {&normals_, vertices}};
  for (const auto& [texture, count] : tables) {
    FOURDVT_ASSIGN(*texture, table(count, "studio table"));
  }
  std::vector<glm::vec3> corners;
  for (uint32_t f = 0; f < surface.topology.faceCount(); ++f)
    for (int k = 0; k < 3; ++k)
      corners.emplace_back(surface.topology.uvs[surface.topology.face_uvs[f][k]], float(faces_[f][k]));
  update(corners_, corners);
  update(rest_, surface.positions);
  return {};
}

Status Renderer::makeTargets(int width, int height) {
  FOURDVT_ASSIGN(resolved_, gpu::makeTexture(*device_, {.width = width, .height = height, .label = "studio picture"}));
  FOURDVT_ASSIGN(picture_, gpu::makeTarget(*device_, {.colors = {resolved_.id()}, .label = "studio picture"}));
  FOURDVT_ASSIGN(samples_, gpu::makeTarget(*device_, {.width = width,
                                                      .height = height,
                                                      .samples = std::min(kMultisamples, device_->caps().max_samples),
                                                      .own_depth = true,
                                                      .label = "studio samples"}));
  return {};
}

void Renderer::update(const gpu::Texture& table, std::span<const glm::vec3> values) {
  const size_t rows = (values.size() + kTableWidth - 1) / kTableWidth;
  scratch_.assign(rows * kTableWidth, glm::vec4(0));
  for (size_t i = 0; i < values.size(); ++i) scratch_[i] = glm::vec4(values[i], 0);
  device_->updateTexture(table.id(), {.width = kTableWidth, .height = static_cast<int>(rows)}, scratch_.data());
}

void Renderer::setPose(const Positions& positions, double place, double phase) {
  computeVertexNormals(faces_, positions.data(), positions.size(), normal_scratch_);
  update(positions_, positions);
  update(normals_, normal_scratch_);
  motion_ = {place, phase};
}

Result<Image> Renderer::draw(const PinholeCamera& camera, double near_m, double far_m, const Shading& shading) {
  const glm::mat4 clip_from_world(clipFromWorld(camera, near_m, far_m));
  const glm::vec3 eye(camera.centreInWorld());
  const glm::vec4 strengths(shading.wrinkles, shading.specular, shading.shading, 0);
  gpu::Pass pass;
  pass.target = samples_.id();
  pass.clear_color = pass.clear_depth = true;
  pass.label = "studio surface";
  device_->beginPass(pass);
  gpu::Draw draw;
  draw.program = program_.id();
  draw.textures = {{"albedo", albedo_.id()},
                   {"corners", corners_.id()},
                   {"positions", positions_.id()},
                   {"normals", normals_.id()},
                   {"rest", rest_.id()}};
  draw.uniforms = {gpu::uniform("clip_from_world", clip_from_world), gpu::uniform("eye", eye),
                   gpu::uniform("shading", strengths), gpu::uniform("motion", motion_)};
  draw.vertex_count = static_cast<int>(3 * faces_.size());
  draw.depth_test = draw.depth_write = true;
  device_->draw(draw);
  device_->endPass();
  device_->blit(samples_.id(), picture_.id(), {.width = width_, .height = height_});
  Image out(width_, height_, 4);
  FOURDVT_TRY(device_->readPixels(picture_.id(), gpu::PixelFormat::RGBA8, {.width = width_, .height = height_},
                                  out.pixels.data()));
  return out;
}

}  // namespace fourdvt::studio
