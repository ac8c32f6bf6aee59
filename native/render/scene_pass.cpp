// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "package/character.h"
#include "render/passes.h"
#include "render/table.h"

namespace fourdvt::render {

Result<SceneMesh> makeSceneMesh(gpu::Device& device, std::span<const SceneCorner> corners, bool occluder_only) {
  if (corners.empty() || corners.size() % 3 != 0)
    return Error{ErrorId::InvalidArgument, "a scene mesh needs three corners per triangle"};
  if (tableRows(2 * corners.size()) > static_cast<uint32_t>(device.caps().max_texture_size))
    return Error{ErrorId::InvalidArgument, "the scene mesh has too many triangles for this GPU: " +
                                               std::to_string(corners.size() / 3) + "; simplify it"};
  auto table = makeTable(device, gpu::PixelFormat::RGBA32F, 2 * corners.size(), "scene corners");
  if (!table) return table.error();
  std::vector<glm::vec4> texels;
  resizeToRows(texels, 2 * corners.size(), glm::vec4(0));
  for (size_t i = 0; i < corners.size(); ++i) {
    if (!std::isfinite(glm::dot(corners[i].position, glm::vec3(1)) + glm::dot(corners[i].color, glm::vec3(1))))
      return Error{ErrorId::InvalidArgument, "a scene mesh needs finite numbers"};
    texels[2 * i] = glm::vec4(corners[i].position, 1);
    texels[2 * i + 1] = glm::vec4(corners[i].color, 1);
  }
  uploadTable(device, table.value(), texels);
  SceneMesh mesh;
  mesh.corners = table.take();
  mesh.corner_count = static_cast<int>(corners.size());
  mesh.occluder_only = occluder_only;
  return mesh;
}

Status setRoom(gpu::Device& device, const package::Room& room, Scene& scene) {
  SceneCorner corners[36];
  for (int i = 0; i < 36; ++i) {
    constexpr int kQuad[6] = {0, 2, 3, 0, 3, 1};  // counter-clockwise seen from inside
    const int face = i / 6, right = kQuad[i % 6] & 1, down = kQuad[i % 6] >> 1;
    const package::Rect& r = room.faces[size_t(face)];
    corners[i] = {
        package::roomPoint(room.box, face, float(right), float(down)),
        {float(r.x + right * r.width) / float(room.width), float(r.y + down * r.height) / float(room.height), 0}};
  }
  FOURDVT_ASSIGN(
      scene.room_picture,
      gpu::makeTexture(
          device, {.width = room.width, .height = room.height, .filter = gpu::Filter::LinearMipmap, .label = "room"}));
  FOURDVT_ASSIGN(scene.room, makeSceneMesh(device, corners, false));
  return {};
}

Status ScenePass::prepare(gpu::Device& device) {
  if (mesh_) return {};
  auto background = makeEmbeddedProgram(device, "fullscreen.vert", "background.frag");
  if (!background) return background.error();
  auto mesh = makeEmbeddedProgram(device, "scene_mesh.vert", "scene_mesh.frag");
  if (!mesh) return mesh.error();
  background_ = background.take();
  mesh_ = mesh.take();
  return {};
}

void ScenePass::draw(gpu::Device& device, const Scene& scene, const View& view) const {
  if (scene.background)
    device.draw({.program = background_.id(), .textures = {{"u_background", scene.background}}, .vertex_count = 3});
  const auto draw = [&](const SceneMesh& mesh, float mode, gpu::TextureId picture) {
    if (!mesh.corners) return;
    device.draw({.program = mesh_.id(),
                 .textures = {{"u_corners", mesh.corners.id()}, {"u_picture", picture}},
                 .uniforms = {gpu::uniform("u_clip_from_world", view.clip_from_world), gpu::uniform("u_mode", mode)},
                 .vertex_count = mesh.corner_count,
                 .depth_test = true,
                 .depth_write = true,
                 .blend = gpu::Blend::PremultipliedOver,
                 .cull = mode > 1 ? gpu::Cull::Back : gpu::Cull::None});
  };
  draw(scene.room, 2, scene.room_picture.id());
  // Bound as a placeholder: these meshes have no picture, but the sampler requires a texture.
  for (const SceneMesh& mesh : scene.meshes) draw(mesh, mesh.occluder_only ? 0.0f : 1.0f, mesh.corners.id());
}

}  // namespace fourdvt::render
