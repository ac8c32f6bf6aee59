// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/gpu_capture.h"

#include <algorithm>

namespace fourdvt::bake {
namespace {

Result<gpu::Texture> makeTable(gpu::Device& device, size_t count, const char* label) {
  gpu::TextureDesc desc;
  desc.format = gpu::PixelFormat::RGBA32F;
  desc.width = kTableWidth;
  desc.height = tableRows(count);
  desc.label = label;
  return gpu::makeTexture(device, desc);
}

}  // namespace

void updateTable(gpu::Device& device, gpu::TextureId table, std::vector<glm::vec4>& values) {
  const int rows = tableRows(values.size());
  values.resize(static_cast<size_t>(rows) * kTableWidth);
  device.updateTexture(table, {.width = kTableWidth, .height = rows}, values.data());
}

Result<GpuCapture> GpuCapture::create(gpu::Device& device, const std::vector<PinholeCamera>& cameras,
                                      const MeshTopology& topology, bool mipmaps, float length_scale) {
  GpuCapture capture;
  capture.mipmaps_ = mipmaps;
  capture.depth_bias_m_ = length_scale * kDepthBias_m;
  capture.face_count_ = static_cast<int>(topology.faceCount());
  capture.vertex_count_ = static_cast<int>(topology.vertex_count);
  FOURDVT_ASSIGN(auto corners, makeTable(device, 3 * size_t(topology.faceCount()), "bake corners"));
  FOURDVT_ASSIGN(auto positions, makeTable(device, topology.vertex_count, "bake positions"));
  FOURDVT_ASSIGN(auto program, gpu::makeProgram(device, "bake depth", gpu::shaderText("bake_depth.vert"),
                                                gpu::shaderText("bake_depth.frag"), kTableDefine));
  capture.corners_ = std::move(corners);
  capture.positions_ = std::move(positions);
  capture.depth_program_ = std::move(program);
  std::vector<glm::vec4> table;
  for (uint32_t f = 0; f < topology.faceCount(); ++f)
    for (int k = 0; k < 3; ++k)
      table.emplace_back(topology.uvs[topology.face_uvs[f][k]], float(topology.face_vertices[f][k]), 0.0f);
  updateTable(device, capture.corners_.id(), table);
  for (const PinholeCamera& pinhole : cameras) {
    Camera camera;
    camera.pinhole = pinhole;
    gpu::TextureDesc desc;
    desc.width = pinhole.width;
    desc.height = pinhole.height;
    desc.filter = mipmaps ? gpu::Filter::LinearMipmap : gpu::Filter::Linear;
    desc.label = "bake picture";
    FOURDVT_ASSIGN(auto picture, gpu::makeTexture(device, desc));
    desc.format = gpu::PixelFormat::Depth24;
    desc.filter = gpu::Filter::Nearest;
    desc.label = "bake depth";
    auto depth = gpu::makeTexture(device, desc);
    if (!depth) return depth.error();
    gpu::TargetDesc target_desc;
    target_desc.depth = depth.value().id();
    target_desc.label = "bake depth";
    FOURDVT_ASSIGN(auto target, gpu::makeTarget(device, target_desc));
    camera.picture = std::move(picture);
    if (mipmaps) camera.uploaded = {0, 0, pinhole.width, pinhole.height, 0, 0};  // new textures have undefined content
    camera.depth = depth.take();
    camera.target = std::move(target);
    camera.cam_from_world = glm::mat4(pinhole.cam_from_world);
    camera.intrinsics = {pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy};
    capture.cameras_.push_back(std::move(camera));
  }
  return capture;
}

// Uploads the crop and, with mipmaps, clears the earlier region: mipmaps mix in pixels around the crop, and remains of
// earlier frames would make a frame depend on them.
void GpuCapture::uploadPicture(gpu::Device& device, Camera& camera, const PictureCrop& crop) {
  const auto update = [&](const PictureRegion& r, const std::vector<uint8_t>& pixels) {
    device.updateTexture(camera.picture.id(), {.x = r.x, .y = r.y, .width = r.width, .height = r.height},
                         pixels.data());
  };
  const PictureRegion &before = camera.uploaded, &now = crop.region;
  const bool covered = before.x >= now.x && before.y >= now.y && before.x + before.width <= now.x + now.width &&
                       before.y + before.height <= now.y + now.height;
  if (mipmaps_ && !before.empty() && !covered) {
    clear_.resize(std::max(clear_.size(), size_t(4) * before.width * before.height));
    update(before, clear_);
  }
  update(now, crop.premultiplied);
  camera.uploaded = now;
  if (mipmaps_) device.generateMipmaps(camera.picture.id());
}

void GpuCapture::setFrame(gpu::Device& device, const Positions& positions, const std::vector<PictureCrop>& crops) {
  scratch_.clear();
  for (const glm::vec3& p : positions) scratch_.emplace_back(p, 1.0f);
  updateTable(device, positions_.id(), scratch_);
  for (size_t c = 0; c < cameras_.size(); ++c) {
    Camera& camera = cameras_[c];
    const PictureCrop& crop = crops[c];
    const PinholeCamera& pinhole = camera.pinhole;
    const float near_m = crop.region.near_m > 0 ? crop.region.near_m : 0.1f,
                far_m = crop.region.near_m > 0 ? crop.region.far_m : 1.0f;
    camera.size_near_far = {pinhole.width, pinhole.height, near_m, far_m};
    camera.clip_from_world = glm::mat4(clipFromWorld(pinhole, near_m, far_m));
    if (!crop.region.empty()) uploadPicture(device, camera, crop);
    gpu::Pass pass;
    pass.target = camera.target.id();
    pass.width = pinhole.width;
    pass.height = pinhole.height;
    pass.clear_depth = true;
    pass.label = "bake depth";
    device.beginPass(pass);
    gpu::Draw draw;
    draw.program = depth_program_.id();
    bindMesh(draw);
    draw.uniforms.push_back(gpu::uniform("clip_from_world", camera.clip_from_world));
    draw.vertex_count = 3 * face_count_;
    draw.depth_test = draw.depth_write = true;
    device.draw(draw);
    device.endPass();
  }
}

void GpuCapture::bindMesh(gpu::Draw& draw) const {
  draw.textures.push_back({"corners", corners_.id()});
  draw.textures.push_back({"positions", positions_.id()});
}

void GpuCapture::bindCamera(size_t c, gpu::Draw& draw) const {
  const Camera& camera = cameras_[c];
  draw.textures.push_back({"picture", camera.picture.id()});
  draw.textures.push_back({"depth_map", camera.depth.id()});
  draw.uniforms.push_back(gpu::uniform("cam_from_world", camera.cam_from_world));
  draw.uniforms.push_back(gpu::uniform("intrinsics", camera.intrinsics));
  draw.uniforms.push_back(gpu::uniform("size_near_far", camera.size_near_far));
  draw.uniforms.push_back(gpu::uniform("depth_bias", depth_bias_m_));
  draw.uniforms.push_back(gpu::uniform("min_cosine", kMinCosine));
}

Result<DrawnTexture> makeDrawnTexture(gpu::Device& device, const gpu::TextureDesc& desc) {
  DrawnTexture drawn;
  FOURDVT_ASSIGN(drawn.texture, gpu::makeTexture(device, desc));
  gpu::TargetDesc target;
  target.colors = {drawn.texture.id()};
  target.label = desc.label;
  FOURDVT_ASSIGN(drawn.target, gpu::makeTarget(device, target));
  return drawn;
}

}  // namespace fourdvt::bake
