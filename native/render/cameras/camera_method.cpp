// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/camera_method.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "render/cameras/camera_blend.h"
#include "render/cameras/unseen_fill.h"

namespace fourdvt::render {
namespace {

constexpr int kMapSide = 1024;  // texels of a depth map, at most
constexpr int kAllCameras = 0;
constexpr float kNearest_m = 0.02f;  // of a map whose camera the surface's box reaches round

struct ShaderOf {
  std::string_view method;
  const char* fragment;
  bool textured;  // from the cameras' pictures
};
constexpr ShaderOf kShaders[] = {{"fvvr", "camera_fvvr.frag", true},
                                 {"wireframe", "camera_wireframe.frag", false},
                                 {"silhouette", "camera_silhouette.frag", false}};

// What one figure of the picture keeps from frame to frame.
struct FigureState {
  std::optional<DepthMaps> maps;
  DepthMapOptions map_options;
  std::vector<PinholeCamera> cameras;  // that the maps are of
  int layers = 0;
  std::vector<PictureRegion> regions;
  uint64_t regions_serial = 0;  // geometry
  UnseenFill fill;
  uint64_t fill_geometry = 0, fill_picture = 0;
  std::vector<size_t> fill_cameras;
  float fill_least_cosine = 0;
  std::vector<size_t> chosen;
};

bool sameCameras(std::span<const PinholeCamera> a, std::span<const PinholeCamera> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PinholeCamera& x, const PinholeCamera& y) {
    return x.width == y.width && x.height == y.height && x.fx == y.fx && x.fy == y.fy && x.cx == y.cx && x.cy == y.cy &&
           x.cam_from_world == y.cam_from_world;
  });
}

class MethodOfShader final : public Method {
 public:
  explicit MethodOfShader(const ShaderOf& shader) : shader_(shader) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    if (options.closest < kAllCameras)
      return Error{ErrorId::InvalidArgument, "closest must be 0 (all cameras) or more"};
    while (figures_.size() <= number) figures_.emplace_back();
    FigureState& state = figures_[number];
    if (!shader_.textured) return prepareProgram(device, state, look, options);
    if (state.regions_serial != model.geometry_serial) setRegions(state, model, look);
    choose(state, look, view, options);
    if (state.chosen.empty()) return Error{ErrorId::InvalidArgument, "no camera has a picture of this frame"};
    FOURDVT_TRY(makeMaps(device, state, look, options));
    state.maps->update(device, model, state.chosen, state.regions);
    if (options.unseen == Unseen::Neighbourhood) FOURDVT_TRY(fill(device, state, model, look, options));
    return prepareProgram(device, state, look, options);
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    const FigureState& state = figures_[number];
    gpu::Draw draw = surfaceDraw(model, programs_.at(definesOf(state, look, options)).id());
    draw.uniforms.push_back(gpu::uniform("u_clip_from_character", view.clip_from_character));
    draw.uniforms.push_back(gpu::uniform("u_eye", view.eye_in_character));
    if (!shader_.textured) return device.draw(draw);
    const CameraUniforms cameras(look.cameras, state.chosen, *state.maps, picturesOf(look), options.least_cosine);
    const int fills = options.unseen != Unseen::Transparent;
    cameras.addTo(draw);
    if (options.unseen == Unseen::Neighbourhood) draw.textures.push_back({"u_fill", state.fill.texture()});
    draw.uniforms.push_back(gpu::uniform("u_fills", fills));
    device.draw(draw);
  }

 private:
  static BlendPictures picturesOf(const CameraLook& look) { return {.tiled = &look, .size = look.picture_size}; }

  // The closest cameras that have a picture and see something of the surface.
  static void choose(FigureState& state, const CameraLook& look, const CharacterView& view,
                     const MethodOptions& options) {
    const int most =
        options.closest == kAllCameras ? kMaxBlendedCameras : std::min(options.closest, kMaxBlendedCameras);
    state.chosen = camerasTowards(look.cameras, viewAxis(view.clip_from_character), kAllCameras);
    std::erase_if(state.chosen, [&](size_t c) { return look.sources[c].source.z <= 0 || state.regions[c].empty(); });
    if (state.chosen.size() > static_cast<size_t>(most)) state.chosen.resize(static_cast<size_t>(most));
  }

  static Status makeMaps(gpu::Device& device, FigureState& state, const CameraLook& look,
                         const MethodOptions& options) {
    int side = 1;
    for (const PinholeCamera& camera : look.cameras) side = std::max({side, camera.width, camera.height});
    const double texels_per_pixel = std::min(1.0, double(kMapSide) / side);
    const int layers = static_cast<int>(state.chosen.size());
    if (state.maps && state.layers >= layers && state.map_options.visibility == options.visibility &&
        sameCameras(state.cameras, look.cameras))
      return {};
    state.maps.reset();
    state.cameras.assign(look.cameras.begin(), look.cameras.end());
    state.layers = layers;
    state.map_options = {.visibility = options.visibility, .texels_per_pixel = texels_per_pixel};
    auto made = DepthMaps::create(device, state.cameras, layers, state.map_options);
    if (!made.ok()) return made.error();
    state.maps = made.take();
    state.fill_geometry = 0;
    return {};
  }

  // Near and far plane of each camera's map from the surface's box (OVH03 5.2.3).
  static void setRegions(FigureState& state, const CharacterModel& model, const CameraLook& look) {
    Positions corners;
    const BoundingBox& box = model.frame_bounds;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
    state.regions.clear();
    for (const PinholeCamera& camera : look.cameras) {
      PictureRegion& region = state.regions.emplace_back(regionOf(camera, corners));
      const bool reaches_round = std::any_of(corners.begin(), corners.end(), [&](const glm::vec3& corner) {
        return camera.project(glm::dvec3(corner)).z <= kNearest_m;
      });
      if (region.empty() || !reaches_round) continue;
      region = {0, 0, camera.width, camera.height, kNearest_m, std::max(region.far_m, 2 * kNearest_m)};
    }
    state.regions_serial = model.geometry_serial;
  }

  static Status fill(gpu::Device& device, FigureState& state, const CharacterModel& model, const CameraLook& look,
                     const MethodOptions& options) {
    if (state.fill_geometry == model.geometry_serial && state.fill_picture == look.serial &&
        state.fill_cameras == state.chosen && state.fill_least_cosine == options.least_cosine)
      return {};
    const BlendPictures pictures = picturesOf(look);
    const CameraUniforms cameras(look.cameras, state.chosen, *state.maps, pictures, options.least_cosine);
    FOURDVT_TRY(state.fill.update(device, model, state.chosen.size(), pictures, cameras));
    state.fill_geometry = model.geometry_serial;
    state.fill_picture = look.serial;
    state.fill_cameras = state.chosen;
    state.fill_least_cosine = options.least_cosine;
    return {};
  }

  std::string definesOf(const FigureState& state, const CameraLook& look, const MethodOptions& options) const {
    if (!shader_.textured) return "";
    return CameraUniforms::defines(state.chosen.size(), picturesOf(look)) +
           (options.unseen == Unseen::Neighbourhood ? "FILLED\n" : "");
  }

  Status prepareProgram(gpu::Device& device, const FigureState& state, const CameraLook& look,
                        const MethodOptions& options) {
    const std::string defines = definesOf(state, look, options);
    gpu::Program& program = programs_[defines];
    if (!program) {
      FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", shader_.fragment, defines));
    }
    return {};
  }

  const ShaderOf shader_;
  std::vector<FigureState> figures_;              // by number
  std::map<std::string, gpu::Program> programs_;  // by their defines
};

}  // namespace

Result<std::unique_ptr<Method>> makeCameraMethod(std::string_view name) {
  for (const ShaderOf& shader : kShaders)
    if (shader.method == name) return std::unique_ptr<Method>(std::make_unique<MethodOfShader>(shader));
  return Error{ErrorId::InvalidArgument, "there is no method " + std::string(name)};
}

}  // namespace fourdvt::render
