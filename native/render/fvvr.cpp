// SPDX-License-Identifier: Apache-2.0
#include "render/fvvr.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "render/passes.h"
#include "render/table.h"

namespace fourdvt::render {
namespace {

constexpr int kOffsetCopies = 5;                       // of the offset multi-draw, as in fvvr_depth.vert
constexpr int kVerticesOfEdges = 18;                   // per face, as in fvvr_edges.vert
constexpr float kRounding = 0.71f, kDiagonal = 1.42f;  // texels: of a place to a texel, and of the offset multi-draw

Error invalid(const std::string& message) { return Error{ErrorId::InvalidArgument, message}; }

// The camera that would take just the crop.
PinholeCamera croppedCamera(PinholeCamera camera, const PictureRegion& crop) {
  camera.cx -= crop.x;
  camera.cy -= crop.y;
  camera.width = crop.width;
  camera.height = crop.height;
  return camera;
}

// Pixels from straight RGBA, rows tightly packed.
void premultiply(const Image& rgba, const PictureRegion& crop, std::vector<uint8_t>& out) {
  out.resize(size_t(crop.width) * crop.height * 4);
  uint8_t* to = out.data();
  for (int y = 0; y < crop.height; ++y) {
    const uint8_t* from = rgba.at(crop.x, crop.y + y);
    for (int x = 0; x < crop.width; ++x, from += 4, to += 4) {
      const unsigned alpha = from[3];
      for (int c = 0; c < 3; ++c) {
        const unsigned product = from[c] * alpha + 128;
        to[c] = static_cast<uint8_t>((product + (product >> 8)) >> 8);
      }
      to[3] = static_cast<uint8_t>(alpha);
    }
  }
}

glm::mat4 pixelFromWorld(const PinholeCamera& camera) {
  glm::dmat4 pixel_from_cam(1.0);
  pixel_from_cam[0][0] = camera.fx;
  pixel_from_cam[1][1] = camera.fy;
  pixel_from_cam[2][0] = camera.cx;
  pixel_from_cam[2][1] = camera.cy;
  return glm::mat4(pixel_from_cam * camera.cam_from_world);
}

template <class T>
Status keep(Result<T> made, T& out) {
  if (!made.ok()) return made.error();
  out = made.take();
  return {};
}

class FvvrOnDevice final : public Fvvr {
 public:
  FvvrOnDevice(gpu::Device& device, std::span<const PinholeCamera> cameras, const MeshTopology& topology,
               const FvvrDepthMaps& maps)
      : device_(device),
        maps_(maps),
        face_vertices_(topology.face_vertices),
        vertex_count_(topology.vertex_count),
        closed_surface_(isClosedSurface(topology.face_vertices)) {
    for (const PinholeCamera& camera : cameras) {
      const auto texels = [&](int pixels) { return std::max(1, int(std::lround(pixels * maps.texels_per_pixel))); };
      cameras_.push_back({.pinhole = camera, .map_columns = texels(camera.width), .map_rows = texels(camera.height)});
      picture_width_ = std::max(picture_width_, camera.width);
      picture_height_ = std::max(picture_height_, camera.height);
      map_width_ = std::max(map_width_, cameras_.back().map_columns);
      map_height_ = std::max(map_height_, cameras_.back().map_rows);
    }
  }

  Status prepare();
  std::vector<size_t> camerasOf(const View& view, const FvvrOptions& options) const override;
  Status setFrame(const Positions& positions, std::span<const Image> pictures,
                  std::span<const size_t> cameras) override {
    FOURDVT_TRY(setGeometry(positions, cameras));
    FOURDVT_TRY(uploadPictures(pictures));
    drawDepthMaps();
    return {};
  }
  Status setGeometry(const Positions& positions, std::span<const size_t> cameras) override;
  Status uploadPictures(std::span<const Image> pictures) override;
  void drawDepthMaps() override;
  Status draw(const View& view, const FvvrOptions& options, gpu::TargetId target) override;
  Result<Image> renderStill(const View& view, const FvvrOptions& options) override;

 private:
  struct Camera {
    PinholeCamera pinhole;
    PictureRegion crop;                 // what the mesh of the frame shown needs
    int map_columns = 0, map_rows = 0;  // texels of the depth map for the whole picture
    gpu::Target depth_map;
    bool is_used = true;       // in the frame shown
    bool has_picture = false;  // uploaded since the camera is in use
  };
  struct Size {
    int width = 0, height = 0, samples = 0;
    bool operator==(const Size&) const = default;
  };

  int cornerCount() const { return static_cast<int>(3 * face_vertices_.size()); }
  gpu::Draw meshDraw(gpu::ProgramId program, int copies) const;
  Status useCameras(std::span<const size_t> cameras);
  Status checkPicture(const PinholeCamera& camera, const Image& picture) const;
  Status checkDraw(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const;
  void drawDepthMap(const Camera& camera);
  void drawEdges(const Camera& camera, const glm::mat4& clip_from_world, const glm::vec2& clip_per_texel);
  void drawMesh(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const;
  Status prepareProgram(size_t camera_count);
  Status resizeScene(const Size& size);
  Status resizeStill(int width, int height);

  gpu::Device& device_;
  const FvvrDepthMaps maps_;
  std::vector<Camera> cameras_;
  std::vector<glm::uvec3> face_vertices_;
  uint32_t vertex_count_ = 0;
  bool closed_surface_ = false, has_geometry_ = false;
  // The largest camera's; smaller ones leave the rest of their layers unused.
  int picture_width_ = 0, picture_height_ = 0, map_width_ = 0, map_height_ = 0;
  gpu::Texture corner_vertices_, positions_normals_, pictures_, depth_maps_;
  gpu::Program depth_program_, edges_program_;
  std::map<size_t, gpu::Program> programs_;  // by number of cameras blended
  gpu::Target scene_;
  Size scene_size_;
  gpu::Texture still_color_;
  gpu::Target still_;
  Size still_size_;
  std::vector<glm::vec3> normals_;  // scratch
  std::vector<glm::vec4> table_;    // scratch
  std::vector<uint8_t> pixels_;     // scratch
};

Status FvvrOnDevice::prepare() {
  const int layers = static_cast<int>(cameras_.size());
  const auto table = [&](gpu::PixelFormat format, size_t texels, const char* label, gpu::Texture& out) {
    return keep(makeTable(device_, format, texels, label), out);
  };
  FOURDVT_TRY(table(gpu::PixelFormat::R32UI, cornerCount(), "fvvr corners", corner_vertices_));
  FOURDVT_TRY(table(gpu::PixelFormat::RGBA32F, 2ull * vertex_count_, "fvvr positions", positions_normals_));
  gpu::TextureDesc map{.format = gpu::PixelFormat::RGBA8,
                       .width = picture_width_,
                       .height = picture_height_,
                       .layers = layers,
                       .filter = gpu::Filter::Linear,
                       .label = "fvvr pictures"};
  FOURDVT_TRY(keep(gpu::makeTexture(device_, map), pictures_));
  map.format = gpu::PixelFormat::Depth24;
  map.width = map_width_, map.height = map_height_;
  map.filter = gpu::Filter::Nearest;
  map.label = "fvvr depth maps";
  FOURDVT_TRY(keep(gpu::makeTexture(device_, map), depth_maps_));
  for (int c = 0; c < layers; ++c)
    FOURDVT_TRY(keep(gpu::makeTarget(device_, {.depth = depth_maps_.id(), .depth_layer = c, .label = "fvvr depth map"}),
                     cameras_[c].depth_map));
  FOURDVT_TRY(keep(makeEmbeddedProgram(device_, "fvvr_depth.vert", "fvvr_depth.frag"), depth_program_));
  if (maps_.visibility == Visibility::Fattened)
    FOURDVT_TRY(keep(makeEmbeddedProgram(device_, "fvvr_edges.vert", "fvvr_depth.frag"), edges_program_));
  std::vector<uint32_t> corners;
  resizeToRows(corners, 3 * face_vertices_.size(), 0u);
  for (size_t f = 0; f < face_vertices_.size(); ++f)
    for (int k = 0; k < 3; ++k) corners[3 * f + k] = face_vertices_[f][k];
  uploadTable(device_, corner_vertices_, corners);
  return {};
}

Status FvvrOnDevice::useCameras(std::span<const size_t> cameras) {
  for (size_t c : cameras)
    if (c >= cameras_.size())
      return invalid("there is no camera " + std::to_string(c) + " among " + std::to_string(cameras_.size()));
  for (Camera& camera : cameras_) camera.is_used = cameras.empty();
  for (size_t c : cameras) cameras_[c].is_used = true;
  for (Camera& camera : cameras_) camera.has_picture &= camera.is_used;
  return {};
}

Status FvvrOnDevice::setGeometry(const Positions& positions, std::span<const size_t> cameras) {
  if (positions.size() != vertex_count_)
    return invalid("the frame has " + std::to_string(positions.size()) + " vertices, the mesh " +
                   std::to_string(vertex_count_));
  FOURDVT_TRY(useCameras(cameras));
  computeVertexNormals(face_vertices_, positions.data(), vertex_count_, normals_);
  resizeToRows(table_, 2ull * vertex_count_, glm::vec4(0));
  for (uint32_t vertex = 0; vertex < vertex_count_; ++vertex) {
    table_[2 * vertex] = glm::vec4(positions[vertex], 1);
    table_[2 * vertex + 1] = glm::vec4(normals_[vertex], 0);
  }
  uploadTable(device_, positions_normals_, table_);
  for (Camera& camera : cameras_)
    if (camera.is_used) camera.crop = regionOf(camera.pinhole, positions);
  has_geometry_ = true;
  return {};
}

Status FvvrOnDevice::checkPicture(const PinholeCamera& camera, const Image& picture) const {
  if (picture.width == camera.width && picture.height == camera.height && picture.channels == 4) return {};
  return invalid("the picture of camera " + camera.name + " must be RGBA of " + std::to_string(camera.width) + "x" +
                 std::to_string(camera.height) + " pixels");
}

Status FvvrOnDevice::uploadPictures(std::span<const Image> pictures) {
  if (!has_geometry_) return invalid("setGeometry goes before uploadPictures");
  if (pictures.size() != cameras_.size())
    return invalid(std::to_string(pictures.size()) + " pictures for " + std::to_string(cameras_.size()) + " cameras");
  for (size_t c = 0; c < pictures.size(); ++c)
    if (cameras_[c].is_used) FOURDVT_TRY(checkPicture(cameras_[c].pinhole, pictures[c]));
  for (size_t c = 0; c < pictures.size(); ++c) {
    const PictureRegion& crop = cameras_[c].crop;
    cameras_[c].has_picture = cameras_[c].is_used;
    if (!cameras_[c].is_used || crop.empty()) continue;
    premultiply(pictures[c], crop, pixels_);
    device_.updateTexture(pictures_.id(), {.x = crop.x, .y = crop.y, .width = crop.width, .height = crop.height},
                          pixels_.data(), 0, static_cast<int>(c));
  }
  return {};
}

gpu::Draw FvvrOnDevice::meshDraw(gpu::ProgramId program, int copies) const {
  return {.program = program,
          .textures = {{"u_corner_vertices", corner_vertices_.id()}, {"u_positions_normals", positions_normals_.id()}},
          .vertex_count = copies * cornerCount(),
          .depth_test = true,
          .depth_write = true,
          .cull = closed_surface_ ? gpu::Cull::Back : gpu::Cull::None};
}

void FvvrOnDevice::drawDepthMaps() {
  if (maps_.visibility == Visibility::None) return;
  for (const Camera& camera : cameras_)
    if (camera.is_used && !camera.crop.empty()) drawDepthMap(camera);
}

void FvvrOnDevice::drawDepthMap(const Camera& camera) {
  // Texels are pixels, or the whole picture is drawn, because the crop's border may lie within a texel.
  const bool same = camera.map_columns == camera.pinhole.width && camera.map_rows == camera.pinhole.height;
  PictureRegion part = camera.crop;
  if (!same) part.x = part.y = 0, part.width = camera.pinhole.width, part.height = camera.pinhole.height;
  const int columns = same ? part.width : camera.map_columns, rows = same ? part.height : camera.map_rows;
  const glm::mat4 clip_from_world(clipFromWorld(croppedCamera(camera.pinhole, part), part.near_m, part.far_m));
  const glm::vec2 clip_per_texel(2.0f / columns, 2.0f / rows);
  device_.beginPass({.target = camera.depth_map.id(),
                     .x = part.x,
                     .y = map_height_ - part.y - rows,
                     .width = columns,
                     .height = rows,
                     .clear_depth = true,
                     .label = "fvvr depth map"});
  if (maps_.visibility == Visibility::Fattened) drawEdges(camera, clip_from_world, clip_per_texel);
  const int corner_count = cornerCount();
  gpu::Draw draw = meshDraw(depth_program_.id(), maps_.visibility == Visibility::Offset ? kOffsetCopies : 1);
  draw.uniforms = {gpu::uniform("u_clip_from_world", clip_from_world), gpu::uniform("u_corner_count", corner_count),
                   gpu::uniform("u_clip_per_texel", clip_per_texel)};
  device_.draw(draw);
  device_.endPass();
}

void FvvrOnDevice::drawEdges(const Camera& camera, const glm::mat4& clip_from_world, const glm::vec2& clip_per_texel) {
  const glm::vec3 centre(camera.pinhole.centreInWorld());
  const glm::vec2 near_far(camera.crop.near_m, camera.crop.far_m);
  const float half_width = float(maps_.line_texels / 2);
  const float texel_span = float(camera.pinhole.width / (camera.pinhole.fx * camera.map_columns));
  const int closed = closed_surface_;
  gpu::Draw draw = meshDraw(edges_program_.id(), 1);
  draw.vertex_count = kVerticesOfEdges * static_cast<int>(face_vertices_.size());
  draw.cull = gpu::Cull::None;
  draw.uniforms = {gpu::uniform("u_clip_from_world", clip_from_world),
                   gpu::uniform("u_centre", centre),
                   gpu::uniform("u_clip_per_texel", clip_per_texel),
                   gpu::uniform("u_near_far", near_far),
                   gpu::uniform("u_half_width", half_width),
                   gpu::uniform("u_texel_span", texel_span),
                   gpu::uniform("u_closed", closed)};
  device_.draw(draw);
}

std::vector<size_t> FvvrOnDevice::camerasOf(const View& view, const FvvrOptions& options) const {
  std::vector<size_t> order(cameras_.size());
  std::iota(order.begin(), order.end(), size_t(0));
  const glm::dvec3 axis(viewAxis(view.clip_from_world));
  const auto cosine = [&](size_t c) { return glm::dot(cameras_[c].pinhole.forwardInWorld(), axis); };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return cosine(a) > cosine(b); });
  if (options.closest > 0) order.resize(std::min(order.size(), static_cast<size_t>(options.closest)));
  return order;
}

Status FvvrOnDevice::prepareProgram(size_t camera_count) {
  gpu::Program& program = programs_[camera_count];
  if (program) return {};
  return keep(makeEmbeddedProgram(device_, "fvvr.vert", "fvvr.frag", "CAMERAS " + std::to_string(camera_count) + "\n"),
              program);
}

void FvvrOnDevice::drawMesh(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const {
  std::vector<glm::mat4> pixel_from_world;
  std::vector<glm::vec4> centres, pixel_spans, sizes;
  for (size_t c : chosen) {
    const PinholeCamera& camera = cameras_[c].pinhole;
    const PictureRegion& crop = cameras_[c].crop;
    pixel_from_world.push_back(pixelFromWorld(camera));
    centres.emplace_back(glm::vec3(camera.centreInWorld()), c);
    pixel_spans.emplace_back(1 / camera.fx, double(cameras_[c].map_columns) / camera.width,
                             double(cameras_[c].map_rows) / camera.height, 0);
    sizes.emplace_back(camera.width, camera.height, crop.near_m, crop.far_m);
  }
  const glm::vec2 picture_size(picture_width_, picture_height_);
  const float reach = maps_.visibility == Visibility::None     ? -1
                      : maps_.visibility == Visibility::Offset ? kRounding + kDiagonal
                                                               : kRounding;
  const int fills = options.fills;
  gpu::Draw draw = meshDraw(programs_.at(chosen.size()).id(), 1);
  draw.textures.push_back({"u_pictures", pictures_.id()});
  draw.textures.push_back({"u_depth_maps", depth_maps_.id()});
  draw.uniforms = {gpu::uniform("u_clip_from_world", view.clip_from_world),
                   gpu::uniform("u_eye_in_world", view.eye_in_world),
                   gpu::uniform("u_picture_size", picture_size),
                   gpu::uniform("u_depth_rows", map_height_),
                   gpu::uniform("u_reach", reach),
                   gpu::uniform("u_fills", fills),
                   gpu::uniform("u_pixel_from_world", std::span<const glm::mat4>(pixel_from_world)),
                   gpu::uniform("u_centres", std::span<const glm::vec4>(centres)),
                   gpu::uniform("u_pixel_spans", std::span<const glm::vec4>(pixel_spans)),
                   gpu::uniform("u_sizes_near_far", std::span<const glm::vec4>(sizes))};
  device_.draw(draw);
}

Status FvvrOnDevice::checkDraw(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const {
  if (view.width < 1 || view.height < 1) return invalid("the view is empty; give it a width and a height");
  if (options.closest < 0) return invalid("closest must be 0 (all cameras) or more");
  for (size_t c : chosen)
    if (!cameras_[c].has_picture)
      return invalid("no picture of camera " + cameras_[c].pinhole.name +
                     ", which this view uses; call setFrame with it before draw");
  return {};
}

Status FvvrOnDevice::draw(const View& view, const FvvrOptions& options, gpu::TargetId target) {
  const std::vector<size_t> chosen = camerasOf(view, options);
  FOURDVT_TRY(checkDraw(view, options, chosen));
  FOURDVT_TRY(prepareProgram(chosen.size()));
  FOURDVT_TRY(resizeScene({view.width, view.height, std::clamp(options.samples, 0, device_.caps().max_samples)}));
  device_.beginPass({.target = scene_.id(),
                     .width = view.width,
                     .height = view.height,
                     .clear_color = true,
                     .clear_depth = true,
                     .color = options.background,
                     .label = "fvvr"});
  drawMesh(view, options, chosen);
  device_.endPass();
  device_.blit(scene_.id(), target, {.width = view.width, .height = view.height});
  return {};
}

Status FvvrOnDevice::resizeScene(const Size& size) {
  if (scene_ && size == scene_size_) return {};
  scene_.reset();
  scene_size_ = size;
  return keep(gpu::makeTarget(device_, {.width = size.width,
                                        .height = size.height,
                                        .samples = size.samples,
                                        .own_depth = true,
                                        .label = "fvvr scene"}),
              scene_);
}

Status FvvrOnDevice::resizeStill(int width, int height) {
  const Size size{width, height, 0};
  if (still_ && size == still_size_) return {};
  still_.reset();
  FOURDVT_TRY(keep(gpu::makeTexture(device_, {.width = width, .height = height, .label = "fvvr still"}), still_color_));
  still_size_ = size;
  return keep(gpu::makeTarget(device_, {.colors = {still_color_.id()}, .label = "fvvr still"}), still_);
}

Result<Image> FvvrOnDevice::renderStill(const View& view, const FvvrOptions& options) {
  const int largest = device_.caps().max_texture_size;
  if (view.width < 1 || view.height < 1 || view.width > largest || view.height > largest)
    return invalid("picture size must be between 1 and " + std::to_string(largest) + " pixels");
  FOURDVT_TRY(resizeStill(view.width, view.height));
  FOURDVT_TRY(draw(view, options, still_.id()));
  Image image(view.width, view.height, 4);
  FOURDVT_TRY(device_.readPixels(still_.id(), gpu::PixelFormat::RGBA8, {.width = view.width, .height = view.height},
                                 image.pixels.data()));
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    uint8_t* p = &image.pixels[i];
    if (p[3] == 0 || p[3] == 255) continue;
    for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::min(255, (p[c] * 255 + p[3] / 2) / p[3]));
  }
  return image;
}

}  // namespace

Result<std::unique_ptr<Fvvr>> Fvvr::create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                           const MeshTopology& topology, const FvvrDepthMaps& maps) {
  if (!(maps.texels_per_pixel > 0 && maps.texels_per_pixel <= 4 && maps.line_texels >= 0))
    return invalid("a depth map takes up to 4 texels per pixel, and its lines have a width of 0 or more texels");
  if (cameras.empty() || cameras.size() > static_cast<size_t>(package::kMaxCameras))
    return invalid("free-viewpoint rendering takes 1 to " + std::to_string(package::kMaxCameras) + " cameras, not " +
                   std::to_string(cameras.size()));
  if (topology.faceCount() == 0) return invalid("the mesh has no faces");
  auto fvvr = std::make_unique<FvvrOnDevice>(device, cameras, topology, maps);
  FOURDVT_TRY(fvvr->prepare());
  return std::unique_ptr<Fvvr>(std::move(fvvr));
}

}  // namespace fourdvt::render
