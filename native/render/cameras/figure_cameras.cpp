// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/figure_cameras.h"

#include <algorithm>

namespace fourdvt::render {
namespace {

constexpr int kMapSide = 1024;  // maximum texels along each side of a depth map
constexpr int kAllCameras = 0;
constexpr float kNearest_m = 0.02f;  // near plane, for a person, of a camera within the surface's box

bool sameCameras(std::span<const PinholeCamera> a, std::span<const PinholeCamera> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PinholeCamera& x, const PinholeCamera& y) {
    return x.width == y.width && x.height == y.height && x.fx == y.fx && x.fy == y.fy && x.cx == y.cx && x.cy == y.cy &&
           x.cam_from_world == y.cam_from_world;
  });
}

}  // namespace

BlendPictures picturesOf(const CameraLook& look) { return {.tiled = &look, .size = look.picture_size}; }

Status FigureCameras::prepare(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                              const CharacterView& view, const MethodOptions& options, int most,
                              std::span<const size_t> also) {
  if (options.closest < kAllCameras) return Error{ErrorId::InvalidArgument, "closest must be 0 (all cameras) or more"};
  length_scale_ = model.length_scale;
  if (regions_serial_ != model.geometry_serial) setRegions(model, look);
  choose(look, view, options, std::min(most, kMaxBlendedCameras), also);
  if (chosen_.empty()) return Error{ErrorId::InvalidArgument, "no camera has a picture of this frame"};
  FOURDVT_TRY(makeMaps(device, look, options));
  maps_->update(device, model, chosen_, regions_);
  fills_ = options.unseen != Unseen::Transparent;
  return options.unseen == Unseen::Neighbourhood ? fill(device, model, look, options) : Status();
}

CameraUniforms FigureCameras::uniforms(const CameraLook& look, const MethodOptions& options) const {
  return CameraUniforms(look.cameras, chosen_, *maps_, picturesOf(look), options.min_cosine, length_scale_);
}

std::string FigureCameras::defines(const CameraLook& look, const MethodOptions& options) const {
  return CameraUniforms::defines(chosen_.size(), picturesOf(look)) +
         (options.unseen == Unseen::Neighbourhood ? "FILLED\n" : "");
}

void FigureCameras::addTo(gpu::Draw& draw, const CharacterView& view, const MethodOptions& options) const {
  draw.uniforms.push_back(gpu::uniform("u_clip_from_character", view.clip_from_character));
  draw.uniforms.push_back(gpu::uniform("u_eye", view.eye_in_character));
  draw.uniforms.push_back(gpu::uniform("u_fills", fills_));
  if (options.unseen == Unseen::Neighbourhood) draw.textures.push_back({"u_fill", fill_.texture()});
}

void FigureCameras::choose(const CameraLook& look, const CharacterView& view, const MethodOptions& options, int most,
                           std::span<const size_t> also) {
  const size_t room = static_cast<size_t>(most);
  const auto isUseless = [&](size_t c) { return look.sources[c].source.z <= 0 || regions_[c].empty(); };
  chosen_ = camerasTowards(look.cameras, viewAxis(view.clip_from_character), kAllCameras);
  std::erase_if(chosen_, isUseless);
  const size_t nearest = options.closest == kAllCameras ? room : std::min(static_cast<size_t>(options.closest), room);
  if (chosen_.size() > nearest) chosen_.resize(nearest);
  nearest_ = chosen_.size();
  for (size_t c : also)
    if (chosen_.size() < room && !isUseless(c) && std::find(chosen_.begin(), chosen_.end(), c) == chosen_.end())
      chosen_.push_back(c);
}

Status FigureCameras::makeMaps(gpu::Device& device, const CameraLook& look, const MethodOptions& options) {
  int side = 1;
  for (const PinholeCamera& camera : look.cameras) side = std::max({side, camera.width, camera.height});
  const double texels_per_pixel = std::min(1.0, double(kMapSide) / side);
  const int layers = static_cast<int>(chosen_.size());
  if (maps_ && layers_ >= layers && map_options_.visibility == options.visibility &&
      sameCameras(cameras_, look.cameras))
    return {};
  maps_.reset();
  cameras_.assign(look.cameras.begin(), look.cameras.end());
  layers_ = layers;
  map_options_ = {.visibility = options.visibility, .texels_per_pixel = texels_per_pixel};
  auto made = DepthMaps::create(device, cameras_, layers, map_options_);
  if (!made.ok()) return made.error();
  maps_ = made.take();
  fill_geometry_ = 0;
  return {};
}

// Computes near and far plane of each camera's map from the surface's box (OVH03 5.2.3).
void FigureCameras::setRegions(const CharacterModel& model, const CameraLook& look) {
  Positions corners;
  const BoundingBox& box = model.frame_bounds;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
  const float nearest_m = kNearest_m * model.length_scale;
  regions_.clear();
  for (const PinholeCamera& camera : look.cameras) {
    PictureRegion& region = regions_.emplace_back(regionOf(camera, corners));
    const bool reaches_round = std::any_of(corners.begin(), corners.end(), [&](const glm::vec3& corner) {
      return camera.project(glm::dvec3(corner)).z <= nearest_m;
    });
    if (region.empty() || !reaches_round) continue;
    region = {0, 0, camera.width, camera.height, nearest_m, std::max(region.far_m, 2 * nearest_m)};
  }
  regions_serial_ = model.geometry_serial;
}

Status FigureCameras::fill(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                           const MethodOptions& options) {
  if (fill_geometry_ == model.geometry_serial && fill_picture_ == look.serial && fill_cameras_ == chosen_ &&
      fill_min_cosine_ == options.min_cosine)
    return {};
  FOURDVT_TRY(fill_.update(device, model, chosen_.size(), picturesOf(look), uniforms(look, options)));
  fill_geometry_ = model.geometry_serial;
  fill_picture_ = look.serial;
  fill_cameras_ = chosen_;
  fill_min_cosine_ = options.min_cosine;
  return {};
}

}  // namespace fourdvt::render
