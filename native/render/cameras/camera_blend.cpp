// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/camera_blend.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "render/table.h"

namespace fourdvt::render {
namespace {

constexpr float kDepthBias_m = 0.01f;  // for a person

glm::mat4 pixelFromCharacter(const PinholeCamera& camera) {
  glm::dmat4 pixel_from_cam(1.0);
  pixel_from_cam[0][0] = camera.fx;
  pixel_from_cam[1][1] = camera.fy;
  pixel_from_cam[2][0] = camera.cx;
  pixel_from_cam[2][1] = camera.cy;
  return glm::mat4(pixel_from_cam * camera.cam_from_world);
}

}  // namespace

std::vector<size_t> camerasTowards(std::span<const PinholeCamera> cameras, const glm::vec3& view_axis, int closest) {
  std::vector<size_t> order(cameras.size());
  std::iota(order.begin(), order.end(), size_t(0));
  const glm::dvec3 axis(view_axis);
  const auto cosine = [&](size_t c) { return glm::dot(cameras[c].middleRayInWorld(), axis); };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return cosine(a) > cosine(b); });
  if (closest > 0) order.resize(std::min(order.size(), static_cast<size_t>(closest)));
  return order;
}

CameraUniforms::CameraUniforms(std::span<const PinholeCamera> cameras, std::span<const size_t> chosen,
                               const DepthMaps& maps, const BlendPictures& pictures, float min_cosine,
                               float length_scale)
    : maps_(maps),
      pictures_(pictures),
      min_cosine_(min_cosine),
      depth_bias_(kDepthBias_m * length_scale),
      reach_(maps.reach()),
      depth_rows_(maps.rows()) {
  for (const size_t chosen_camera : chosen) {
    const bool is_blind = chosen_camera >= cameras.size();
    const size_t c = is_blind ? *std::min_element(chosen.begin(), chosen.end()) : chosen_camera;
    const PinholeCamera& camera = cameras[c];
    const glm::vec2 texels = maps.texelsPerPixel(c), near_far = maps.nearFar(c);
    pixel_from_character_.push_back(pixelFromCharacter(camera));
    centres_.emplace_back(glm::vec3(camera.centreInWorld()), maps.layerOf(c));
    pixel_spans_.emplace_back(1 / camera.fx, texels.x, texels.y, c);
    sizes_near_far_.emplace_back(is_blind ? 0 : camera.width, is_blind ? 0 : camera.height, near_far.x, near_far.y);
    if (!pictures.tiled) continue;
    sources_.push_back(pictures.tiled->sources[c].source);
    tiles_.push_back(pictures.tiled->sources[c].tile);
  }
}

void CameraUniforms::addTo(gpu::Draw& draw) const {
  draw.textures.push_back({"u_depth_maps", maps_.texture()});
  if (!pictures_.tiled) {
    draw.textures.push_back({"u_pictures", pictures_.array});
  } else {
    addPicture(draw.textures, *pictures_.tiled->picture);
  }
  for (const gpu::Uniform& uniform :
       {gpu::uniform("u_picture_size", pictures_.size), gpu::uniform("u_depth_rows", depth_rows_),
        gpu::uniform("u_reach", reach_), gpu::uniform("u_depth_bias", depth_bias_),
        gpu::uniform("u_least_cosine", min_cosine_),
        gpu::uniform("u_pixel_from_character", std::span<const glm::mat4>(pixel_from_character_)),
        gpu::uniform("u_centres", std::span<const glm::vec4>(centres_)),
        gpu::uniform("u_pixel_spans", std::span<const glm::vec4>(pixel_spans_)),
        gpu::uniform("u_sizes_near_far", std::span<const glm::vec4>(sizes_near_far_))})
    draw.uniforms.push_back(uniform);
  if (!pictures_.tiled) return;
  draw.uniforms.push_back(gpu::uniform("u_sources", std::span<const glm::vec4>(sources_)));
  draw.uniforms.push_back(gpu::uniform("u_tiles", std::span<const glm::vec4>(tiles_)));
}

std::string CameraUniforms::defines(size_t camera_count, const BlendPictures& pictures) {
  std::string defines = "CAMERAS " + std::to_string(camera_count) + "\n";
  if (!pictures.tiled) return defines;
  return defines + "TILED\n" + definesOf(pictures.tiled->picture->kind);
}

Status UnseenFill::makeTables(gpu::Device& device, const CharacterModel& model) {
  if (model.vertex_count <= table_vertices_) return {};
  // Reserves a quarter more, since the next surface has a similar size.
  const uint32_t vertices = std::min(model.vertex_count + model.vertex_count / 4, model.maxVertices());
  table_vertices_ = 0;
  for (Table* table : {&seen_, &colors_[0], &colors_[1]}) {
    *table = {};
    FOURDVT_ASSIGN(table->texture, makeTable(device, gpu::PixelFormat::RGBA8, vertices, "vertices' colours"));
    FOURDVT_ASSIGN(table->target,
                   gpu::makeTarget(device, {.colors = {table->texture.id()}, .label = "vertices' colours"}));
  }
  table_vertices_ = vertices;
  return {};
}

Status UnseenFill::update(gpu::Device& device, const CharacterModel& model, size_t camera_count,
                          const BlendPictures& pictures, const CameraUniforms& cameras) {
  FOURDVT_TRY(makeTables(device, model));
  FOURDVT_TRY(neighbours_.update(device, model));
  const std::string defines = CameraUniforms::defines(camera_count, pictures);
  gpu::Program& seen_program = seen_programs_[defines];
  if (!seen_program) {
    FOURDVT_ASSIGN(seen_program, makeCameraProgram(device, "camera_fullscreen.vert", "camera_fill_seen.frag", defines));
  }
  if (!spread_program_) {
    FOURDVT_ASSIGN(spread_program_, makeCameraProgram(device, "camera_fullscreen.vert", "camera_fill_spread.frag"));
  }
  const int vertex_count = static_cast<int>(model.vertex_count), rows = static_cast<int>(tableRows(model.vertex_count));
  const auto draw = [&](const Table& to, const gpu::Draw& what) {
    device.beginPass({.target = to.target.id(), .width = CharacterModel::kTableWidth, .height = rows, .label = "fill"});
    device.draw(what);
    device.endPass();
  };
  gpu::Draw seen{.program = seen_program.id(),
                 .textures = {{"u_positions_normals", model.positions_normals.id()}},
                 .uniforms = {gpu::uniform("u_vertex_count", vertex_count)},
                 .vertex_count = 3};
  cameras.addTo(seen);
  draw(seen_, seen);
  static_assert(kSteps % 2 == 0);  // the last step must write the first table
  for (int step = 0; step < kSteps; ++step) {
    const gpu::TextureId before = step == 0 ? seen_.texture.id() : colors_[step % 2].texture.id();
    draw(colors_[(step + 1) % 2],
         {.program = spread_program_.id(),
          .textures = {{"u_seen", seen_.texture.id()}, {"u_before", before}, {"u_neighbours", neighbours_.texture()}},
          .uniforms = {gpu::uniform("u_vertex_count", vertex_count)},
          .vertex_count = 3});
  }
  return {};
}

}  // namespace fourdvt::render
