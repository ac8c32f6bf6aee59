// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/depth_maps.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace fourdvt::render {

std::string_view cameraShaderText(std::string_view name);  // embedded; see CMakeLists.txt

namespace {

constexpr int kOffsetCopies = 5;      // copies of the offset multi-draw, as in camera_depth.vert
constexpr int kVerticesOfEdges = 18;  // per face, as in camera_edges.vert
constexpr float kRounding = 0.71f,
                kDiagonal = 1.42f;  // texels: rounding of a position to a texel, and diagonal of the offset multi-draw

// Returns the camera of the cropped picture.
PinholeCamera croppedCamera(PinholeCamera camera, const PictureRegion& crop) {
  camera.cx -= crop.x;
  camera.cy -= crop.y;
  camera.width = crop.width;
  camera.height = crop.height;
  return camera;
}

}  // namespace

Result<gpu::Program> makeCameraProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                       const std::string& defines) {
  const std::string all = "INDEXED\nTABLE_WIDTH " + std::to_string(CharacterModel::kTableWidth) + "\n" + defines;
  return gpu::makeProgram(device, std::string(vertex) + " + " + fragment, cameraShaderText(vertex),
                          cameraShaderText(fragment), all);
}

gpu::Draw surfaceDraw(const CharacterModel& model, gpu::ProgramId program) {
  return {.program = program,
          .textures = {{"u_corner_vertices", model.corner_vertices.id()},
                       {"u_positions_normals", model.positions_normals.id()}},
          .vertex_count = static_cast<int>(3 * model.face_count),
          .depth_test = true,
          .depth_write = true,
          .cull = model.closed_surface ? gpu::Cull::Back : gpu::Cull::None};
}

Result<DepthMaps> DepthMaps::create(gpu::Device& device, std::span<const PinholeCamera> cameras, int layers,
                                    const DepthMapOptions& options) {
  if (!(options.texels_per_pixel > 0 && options.texels_per_pixel <= 4 && options.line_texels >= 0))
    return Error{ErrorId::InvalidArgument,
                 "a depth map takes up to 4 texels per pixel, and its lines have a width of 0 or more texels"};
  DepthMaps maps;
  maps.options_ = options;
  int width = 1;
  for (const PinholeCamera& camera : cameras) {
    const auto texels = [&](int pixels) { return std::max(1, int(std::lround(pixels * options.texels_per_pixel))); };
    maps.cameras_.push_back({.pinhole = camera, .columns = texels(camera.width), .rows = texels(camera.height)});
    width = std::max(width, maps.cameras_.back().columns);
    maps.height_ = std::max(maps.height_, maps.cameras_.back().rows);
  }
  FOURDVT_ASSIGN(maps.texture_, gpu::makeTexture(device, {.format = gpu::PixelFormat::Depth24,
                                                          .width = width,
                                                          .height = maps.height_,
                                                          .layers = layers,
                                                          .label = "cameras' depth maps"}));
  for (int layer = 0; layer < layers; ++layer) {
    maps.targets_.emplace_back();
    FOURDVT_ASSIGN(maps.targets_.back(),
                   gpu::makeTarget(device, {.depth = maps.texture_.id(), .depth_layer = layer, .label = "depth map"}));
  }
  FOURDVT_ASSIGN(maps.depth_program_, makeCameraProgram(device, "camera_depth.vert", "camera_depth.frag"));
  if (options.visibility == Visibility::Fattened) {
    FOURDVT_ASSIGN(maps.edges_program_, makeCameraProgram(device, "camera_edges.vert", "camera_depth.frag"));
  }
  return maps;
}

glm::vec2 DepthMaps::texelsPerPixel(size_t camera) const {
  const Camera& c = cameras_[camera];
  return {double(c.columns) / c.pinhole.width, double(c.rows) / c.pinhole.height};
}

float DepthMaps::reach() const {
  if (options_.visibility == Visibility::None) return -1;
  return options_.visibility == Visibility::Offset ? kRounding + kDiagonal : kRounding;
}

// Assigns layers: cameras keep theirs; the others take layers of cameras that are not in use.
void DepthMaps::place(std::span<const size_t> cameras) {
  const auto isUsed = [&](size_t c) { return std::find(cameras.begin(), cameras.end(), c) != cameras.end(); };
  std::vector<bool> taken(targets_.size(), false);
  for (size_t c = 0; c < cameras_.size(); ++c) {
    if (!isUsed(c)) cameras_[c].layer = -1;
    if (cameras_[c].layer >= 0) taken[size_t(cameras_[c].layer)] = true;
  }
  for (size_t c : cameras) {
    Camera& camera = cameras_[c];
    if (camera.layer >= 0) continue;
    const auto free = std::find(taken.begin(), taken.end(), false);
    *free = true;
    camera.layer = static_cast<int>(free - taken.begin());
    camera.serial = 0;
  }
}

int DepthMaps::update(gpu::Device& device, const CharacterModel& model, std::span<const size_t> cameras,
                      std::span<const PictureRegion> regions) {
  int drawn = 0;
  place(cameras);
  for (size_t c : cameras) {
    Camera& camera = cameras_[c];
    if (camera.serial == model.geometry_serial) continue;
    camera.serial = model.geometry_serial;
    camera.region = regions[c];
    if (camera.region.empty() || options_.visibility == Visibility::None) continue;
    drawMap(device, model, camera);
    ++drawn;
  }
  return drawn;
}

void DepthMaps::forget() {
  for (Camera& camera : cameras_) camera.serial = 0;
}

void DepthMaps::drawMap(gpu::Device& device, const CharacterModel& model, const Camera& camera) const {
  // Restricts the viewport to the region only where texels are pixels; otherwise the region's border may lie within a
  // texel, and the whole picture is drawn.
  const bool same = camera.columns == camera.pinhole.width && camera.rows == camera.pinhole.height;
  PictureRegion part = camera.region;
  if (!same) part.x = part.y = 0, part.width = camera.pinhole.width, part.height = camera.pinhole.height;
  const int columns = same ? part.width : camera.columns, rows = same ? part.height : camera.rows;
  const glm::mat4 clip_from_character(clipFromWorld(croppedCamera(camera.pinhole, part), part.near_m, part.far_m));
  const glm::vec2 clip_per_texel(2.0f / columns, 2.0f / rows);
  device.beginPass({.target = targets_[size_t(camera.layer)].id(),
                    .x = part.x,
                    .y = height_ - part.y - rows,
                    .width = columns,
                    .height = rows,
                    .clear_depth = true,
                    .label = "depth map"});
  if (options_.visibility == Visibility::Fattened)
    drawEdges(device, model, camera, clip_from_character, clip_per_texel);
  gpu::Draw draw = surfaceDraw(model, depth_program_.id());
  const int corner_count = draw.vertex_count;
  if (options_.visibility == Visibility::Offset) draw.vertex_count *= kOffsetCopies;
  draw.uniforms = {gpu::uniform("u_clip_from_character", clip_from_character),
                   gpu::uniform("u_corner_count", corner_count), gpu::uniform("u_clip_per_texel", clip_per_texel)};
  device.draw(draw);
  device.endPass();
}

void DepthMaps::drawEdges(gpu::Device& device, const CharacterModel& model, const Camera& camera,
                          const glm::mat4& clip_from_character, const glm::vec2& clip_per_texel) const {
  const glm::vec3 centre(camera.pinhole.centreInWorld());
  const glm::vec2 near_far(camera.region.near_m, camera.region.far_m);
  const float half_width = float(options_.line_texels / 2);
  const float texel_span = float(camera.pinhole.width / (camera.pinhole.fx * camera.columns));
  const int closed = model.closed_surface;
  gpu::Draw draw = surfaceDraw(model, edges_program_.id());
  draw.vertex_count = kVerticesOfEdges * static_cast<int>(model.face_count);
  draw.cull = gpu::Cull::None;
  draw.uniforms = {gpu::uniform("u_clip_from_character", clip_from_character),
                   gpu::uniform("u_centre", centre),
                   gpu::uniform("u_clip_per_texel", clip_per_texel),
                   gpu::uniform("u_near_far", near_far),
                   gpu::uniform("u_half_width", half_width),
                   gpu::uniform("u_texel_span", texel_span),
                   gpu::uniform("u_closed", closed)};
  device.draw(draw);
}

}  // namespace fourdvt::render
