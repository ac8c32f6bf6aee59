// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/fvvr.h"

#include <algorithm>

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

std::string definesOf(const FvvrOptions& options, size_t camera_count) {
  return CameraUniforms::defines(camera_count, {}) + "FACING_EXPONENT " + std::to_string(options.facing_exponent) +
         "\nVIEW_EXPONENT " + std::to_string(options.view_exponent) + "\n" + (options.sharp ? "SHARP\n" : "") +
         (options.unseen == Unseen::Neighbourhood ? "FILLED\n" : "");
}

template <class T>
Status keep(Result<T> made, T& out) {
  if (!made.ok()) return made.error();
  out = made.take();
  return {};
}

}  // namespace

FvvrOptions tunedFvvr() {
  return {.closest = 4,
          .unseen = Unseen::Neighbourhood,
          .facing_exponent = 2,
          .view_exponent = 2,
          .min_cosine = .1f,
          .sharp = true};
}

Fvvr::Fvvr(gpu::Device& device, std::span<const PinholeCamera> cameras)
    : device_(device), pinholes_(cameras.begin(), cameras.end()), cameras_(cameras.size()), regions_(cameras.size()) {
  for (const PinholeCamera& camera : cameras) {
    picture_width_ = std::max(picture_width_, camera.width);
    picture_height_ = std::max(picture_height_, camera.height);
  }
}

Status Fvvr::prepare(const MeshTopology& topology, const DepthMapOptions& maps, float length_scale) {
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

Status Fvvr::useCameras(std::span<const size_t> cameras) {
  for (size_t c : cameras)
    if (c >= cameras_.size())
      return invalid("there is no camera " + std::to_string(c) + " among " + std::to_string(cameras_.size()));
  for (Camera& camera : cameras_) camera.is_used = cameras.empty();
  for (size_t c : cameras) cameras_[c].is_used = true;
  for (Camera& camera : cameras_) camera.has_picture &= camera.is_used;
  return {};
}

Status Fvvr::setFrame(const Positions& positions, std::span<const Image> pictures, std::span<const size_t> cameras) {
  FOURDVT_TRY(setGeometry(positions, cameras));
  FOURDVT_TRY(uploadPictures(pictures));
  drawDepthMaps();
  return {};
}

Status Fvvr::setGeometry(const Positions& positions, std::span<const size_t> cameras) {
  if (positions.size() != model_.vertex_count)
    return invalid("the frame has " + std::to_string(positions.size()) + " vertices, the mesh " +
                   std::to_string(model_.vertex_count));
  FOURDVT_TRY(useCameras(cameras));
  fill_min_cosine_.reset();
  model_.setPositions(device_, positions);
  for (size_t c : usedCameras()) regions_[c] = regionOf(pinholes_[c], positions);
  return {};
}

std::vector<size_t> Fvvr::usedCameras() const {
  std::vector<size_t> used;
  for (size_t c = 0; c < cameras_.size(); ++c)
    if (cameras_[c].is_used) used.push_back(c);
  return used;
}

Status Fvvr::checkPicture(const PinholeCamera& camera, const Image& picture) const {
  if (picture.width == camera.width && picture.height == camera.height && picture.channels == 4) return {};
  return invalid("the picture of camera " + camera.name + " must be RGBA of " + std::to_string(camera.width) + "x" +
                 std::to_string(camera.height) + " pixels");
}

Status Fvvr::uploadPictures(std::span<const Image> pictures) {
  if (model_.geometry_serial == 0) return invalid("setGeometry goes before uploadPictures");
  if (pictures.size() != cameras_.size())
    return invalid(std::to_string(pictures.size()) + " pictures for " + std::to_string(cameras_.size()) + " cameras");
  for (size_t c = 0; c < pictures.size(); ++c)
    if (cameras_[c].is_used) FOURDVT_TRY(checkPicture(pinholes_[c], pictures[c]));
  fill_min_cosine_.reset();
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

void Fvvr::drawDepthMaps() {
  maps_->forget();
  maps_->update(device_, model_, usedCameras(), regions_);
}

std::vector<size_t> Fvvr::camerasOf(const View& view, const FvvrOptions& options) const {
  return camerasTowards(pinholes_, viewAxis(view.clip_from_world), options.closest);
}

Status Fvvr::prepareProgram(const FvvrOptions& options, size_t camera_count) {
  const std::string defines = definesOf(options, camera_count);
  gpu::Program& program = programs_[defines];
  if (program) return {};
  return keep(makeCameraProgram(device_, "camera_surface.vert", "camera_fvvr_tuned.frag", defines), program);
}

CameraUniforms Fvvr::uniformsOf(const FvvrOptions& options, std::span<const size_t> cameras) const {
  const BlendPictures pictures{.array = pictures_.id(), .size = glm::vec2(picture_width_, picture_height_)};
  return CameraUniforms(pinholes_, cameras, *maps_, pictures, options.min_cosine, model_.length_scale);
}

Status Fvvr::fillUnseen(const FvvrOptions& options) {
  if (options.unseen != Unseen::Neighbourhood || fill_min_cosine_ == options.min_cosine) return {};
  const std::vector<size_t> cameras = usedCameras();
  FOURDVT_TRY(fill_.update(device_, model_, cameras.size(), {}, uniformsOf(options, cameras)));
  fill_min_cosine_ = options.min_cosine;
  return {};
}

void Fvvr::drawMesh(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const {
  const CameraUniforms cameras = uniformsOf(options, chosen);
  const int fills = options.unseen != Unseen::Transparent;
  gpu::Draw draw = surfaceDraw(model_, programs_.at(definesOf(options, chosen.size())).id());
  cameras.addTo(draw);
  draw.uniforms.push_back(gpu::uniform("u_clip_from_character", view.clip_from_world));
  draw.uniforms.push_back(gpu::uniform("u_eye", view.eye_in_world));
  draw.uniforms.push_back(gpu::uniform("u_fills", fills));
  if (options.unseen == Unseen::Neighbourhood) draw.textures.push_back({"u_fill", fill_.texture()});
  device_.draw(draw);
}

Status Fvvr::checkDraw(const View& view, const FvvrOptions& options, const std::vector<size_t>& chosen) const {
  if (view.width < 1 || view.height < 1) return invalid("the view is empty; give it a width and a height");
  if (options.closest < 0) return invalid("closest must be 0 (all cameras) or more");
  if (!(options.facing_exponent >= 0 && options.view_exponent >= 0))
    return invalid("facing_exponent and view_exponent must be 0 or more");
  if (!(options.min_cosine >= 0 && options.min_cosine < 1)) return invalid("min_cosine must be from 0 to below 1");
  for (size_t c : chosen)
    if (!cameras_[c].has_picture)
      return invalid("no picture of camera " + pinholes_[c].name +
                     ", which this view uses; call setFrame with it before draw");
  return {};
}

Status Fvvr::draw(const View& view, const FvvrOptions& options, gpu::TargetId target) {
  const std::vector<size_t> chosen = camerasOf(view, options);
  FOURDVT_TRY(checkDraw(view, options, chosen));
  FOURDVT_TRY(prepareProgram(options, chosen.size()));
  FOURDVT_TRY(fillUnseen(options));
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

Status Fvvr::resizeScene(const Size& size) {
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

Status Fvvr::resizeStill(int width, int height) {
  const Size size{width, height, 0};
  if (still_ && size == still_size_) return {};
  still_.reset();
  FOURDVT_TRY(keep(gpu::makeTexture(device_, {.width = width, .height = height, .label = "fvvr still"}), still_color_));
  still_size_ = size;
  return keep(gpu::makeTarget(device_, {.colors = {still_color_.id()}, .label = "fvvr still"}), still_);
}

Result<Image> Fvvr::renderStill(const View& view, const FvvrOptions& options) {
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

Result<std::unique_ptr<Fvvr>> Fvvr::create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                           const MeshTopology& topology, const DepthMapOptions& maps,
                                           float length_scale) {
  if (cameras.empty() || cameras.size() > static_cast<size_t>(package::kMaxCameras))
    return invalid("free-viewpoint rendering takes 1 to " + std::to_string(package::kMaxCameras) + " cameras, not " +
                   std::to_string(cameras.size()));
  if (topology.faceCount() == 0) return invalid("the mesh has no faces");
  std::unique_ptr<Fvvr> fvvr(new Fvvr(device, cameras));
  FOURDVT_TRY(fvvr->prepare(topology, maps, length_scale));
  return fvvr;
}

}  // namespace fourdvt::render
