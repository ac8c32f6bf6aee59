// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/fvvr.h"

#include <algorithm>
#include <map>
#include <optional>

#include "render/cameras/camera_blend.h"

namespace fourdvt::render {
namespace {

Error invalid(const std::string& message) { return Error{ErrorId::InvalidArgument, message}; }

// Premultiplies straight RGBA; output rows are tightly packed.
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

template <class T>
Status keep(Result<T> made, T& out) {
  if (!made.ok()) return made.error();
  out = made.take();
  return {};
}

class FvvrOnDevice final : public Fvvr {
 public:
  FvvrOnDevice(gpu::Device& device, std::span<const PinholeCamera> cameras)
      : device_(device), pinholes_(cameras.begin(), cameras.end()), cameras_(cameras.size()), regions_(cameras.size()) {
    for (const PinholeCamera& camera : cameras) {
      picture_width_ = std::max(picture_width_, camera.width);
      picture_height_ = std::max(picture_height_, camera.height);
    }
  }

  Status prepare(const MeshTopology& topology, const DepthMapOptions& maps, float length_scale);
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
    bool is_used = true;       // used in the current frame
    bool has_picture = false;  // uploaded since the camera came into use
  };
  struct Size {
    int width = 0, height = 0, samples = 0;
    bool operator==(const Size&) const = default;
  };

  Status useCameras(std::span<const size_t> cameras);
  Status checkPicture(const PinholeCamera& camera, const Image& picture) const;
  Status checkDraw(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const;
  std::vector<size_t> usedCameras() const;
  void drawMesh(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const;
  Status prepareProgram(size_t camera_count);
  Status resizeScene(const Size& size);
  Status resizeStill(int width, int height);

  gpu::Device& device_;
  const std::vector<PinholeCamera> pinholes_;
  std::vector<Camera> cameras_;
  std::vector<PictureRegion> regions_;  // per camera: part of its picture that the current mesh covers
  CharacterModel model_;
  std::optional<DepthMaps> maps_;
  // Size of the largest camera's picture; smaller ones use part of their layers.
  int picture_width_ = 0, picture_height_ = 0;
  gpu::Texture pictures_;
  std::map<size_t, gpu::Program> programs_;  // keyed by number of cameras blended
  gpu::Target scene_;
  Size scene_size_;
  gpu::Texture still_color_;
  gpu::Target still_;
  Size still_size_;
  std::vector<uint8_t> pixels_;  // scratch
};

Status FvvrOnDevice::prepare(const MeshTopology& topology, const DepthMapOptions& maps, float length_scale) {
  package::Character character;
  character.cameras = pinholes_;
  character.length_scale = length_scale;
  character.vertex_count = topology.vertex_count;
  character.face_count = topology.faceCount();
  FOURDVT_TRY(keep(CharacterModel::createForSurfaces(device_, character), model_));
  FOURDVT_TRY(model_.setTopology(device_, topology.face_vertices, topology.vertex_count));
  FOURDVT_TRY(keep(gpu::makeTexture(device_, {.format = gpu::PixelFormat::RGBA8,
                                              .width = picture_width_,
                                              .height = picture_height_,
                                              .layers = static_cast<int>(cameras_.size()),
                                              .filter = gpu::Filter::Linear,
                                              .label = "fvvr pictures"}),
                   pictures_));
  auto made = DepthMaps::create(device_, pinholes_, static_cast<int>(cameras_.size()), maps);
  if (!made.ok()) return made.error();
  maps_ = made.take();
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
  if (positions.size() != model_.vertex_count)
    return invalid("the frame has " + std::to_string(positions.size()) + " vertices, the mesh " +
                   std::to_string(model_.vertex_count));
  FOURDVT_TRY(useCameras(cameras));
  model_.setPositions(device_, positions);
  for (size_t c : usedCameras()) regions_[c] = regionOf(pinholes_[c], positions);
  return {};
}

std::vector<size_t> FvvrOnDevice::usedCameras() const {
  std::vector<size_t> used;
  for (size_t c = 0; c < cameras_.size(); ++c)
    if (cameras_[c].is_used) used.push_back(c);
  return used;
}

Status FvvrOnDevice::checkPicture(const PinholeCamera& camera, const Image& picture) const {
  if (picture.width == camera.width && picture.height == camera.height && picture.channels == 4) return {};
  return invalid("the picture of camera " + camera.name + " must be RGBA of " + std::to_string(camera.width) + "x" +
                 std::to_string(camera.height) + " pixels");
}

Status FvvrOnDevice::uploadPictures(std::span<const Image> pictures) {
  if (model_.geometry_serial == 0) return invalid("setGeometry goes before uploadPictures");
  if (pictures.size() != cameras_.size())
    return invalid(std::to_string(pictures.size()) + " pictures for " + std::to_string(cameras_.size()) + " cameras");
  for (size_t c = 0; c < pictures.size(); ++c)
    if (cameras_[c].is_used) FOURDVT_TRY(checkPicture(pinholes_[c], pictures[c]));
  for (size_t c = 0; c < pictures.size(); ++c) {
    const PictureRegion& crop = regions_[c];
    cameras_[c].has_picture = cameras_[c].is_used;
    if (!cameras_[c].is_used || crop.empty()) continue;
    premultiply(pictures[c], crop, pixels_);
    device_.updateTexture(pictures_.id(), {.x = crop.x, .y = crop.y, .width = crop.width, .height = crop.height},
                          pixels_.data(), 0, static_cast<int>(c));
  }
  return {};
}

void FvvrOnDevice::drawDepthMaps() {
  maps_->forget();
  maps_->update(device_, model_, usedCameras(), regions_);
}

std::vector<size_t> FvvrOnDevice::camerasOf(const View& view, const FvvrOptions& options) const {
  return camerasTowards(pinholes_, viewAxis(view.clip_from_world), options.closest);
}

Status FvvrOnDevice::prepareProgram(size_t camera_count) {
  gpu::Program& program = programs_[camera_count];
  if (program) return {};
  return keep(
      makeCameraProgram(device_, "camera_surface.vert", "camera_fvvr.frag", CameraUniforms::defines(camera_count, {})),
      program);
}

void FvvrOnDevice::drawMesh(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const {
  const BlendPictures pictures{.array = pictures_.id(), .size = glm::vec2(picture_width_, picture_height_)};
  const CameraUniforms cameras(pinholes_, chosen, *maps_, pictures, 0, model_.length_scale);
  const int fills = options.fills;
  gpu::Draw draw = surfaceDraw(model_, programs_.at(chosen.size()).id());
  cameras.addTo(draw);
  draw.uniforms.push_back(gpu::uniform("u_clip_from_character", view.clip_from_world));
  draw.uniforms.push_back(gpu::uniform("u_eye", view.eye_in_world));
  draw.uniforms.push_back(gpu::uniform("u_fills", fills));
  device_.draw(draw);
}

Status FvvrOnDevice::checkDraw(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const {
  if (view.width < 1 || view.height < 1) return invalid("the view is empty; give it a width and a height");
  if (options.closest < 0) return invalid("closest must be 0 (all cameras) or more");
  for (size_t c : chosen)
    if (!cameras_[c].has_picture)
      return invalid("no picture of camera " + pinholes_[c].name +
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
                                           const MeshTopology& topology, const DepthMapOptions& maps,
                                           float length_scale) {
  if (cameras.empty() || cameras.size() > static_cast<size_t>(package::kMaxCameras))
    return invalid("free-viewpoint rendering takes 1 to " + std::to_string(package::kMaxCameras) + " cameras, not " +
                   std::to_string(cameras.size()));
  if (topology.faceCount() == 0) return invalid("the mesh has no faces");
  auto fvvr = std::make_unique<FvvrOnDevice>(device, cameras);
  FOURDVT_TRY(fvvr->prepare(topology, maps, length_scale));
  return std::unique_ptr<Fvvr>(std::move(fvvr));
}

}  // namespace fourdvt::render
