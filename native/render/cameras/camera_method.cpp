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

struct ShaderOf {
  std::string_view method;
  const char* fragment;
};
constexpr ShaderOf kShaders[] = {
    {"fvvr", "camera_fvvr.frag"}, {"wireframe", "camera_wireframe.frag"}, {"silhouette", "camera_silhouette.frag"}};

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
  explicit MethodOfShader(const char* fragment) : fragment_(fragment) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    if (options.closest < kAllCameras)
      return Error{ErrorId::InvalidArgument, "closest must be 0 (all cameras) or more"};
    while (figures_.size() <= number) figures_.emplace_back();
    FigureState& state = figures_[number];
    choose(state, look, view, options);
    if (state.chosen.empty()) return Error{ErrorId::InvalidArgument, "no camera has a picture of this frame"};
    FOURDVT_TRY(makeMaps(device, state, look, options));
    if (state.regions_serial != model.geometry_serial) setRegions(state, model, look);
    state.maps->update(device, model, state.chosen, state.regions);
    if (options.unseen == Unseen::Neighbourhood) FOURDVT_TRY(fill(device, state, model, look, options));
    return prepareProgram(device, state, look, options);
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    const FigureState& state = figures_[number];
    const BlendPictures pictures = picturesOf(look);
    const CameraUniforms cameras(look.cameras, state.chosen, *state.maps, pictures, options.least_cosine);
    const int fills = options.unseen != Unseen::Transparent;
    gpu::Draw draw = surfaceDraw(model, programs_.at(definesOf(state, look, options)).id());
    cameras.addTo(draw);
    if (options.unseen == Unseen::Neighbourhood) draw.textures.push_back({"u_fill", state.fill.texture()});
    draw.uniforms.push_back(gpu::uniform("u_clip_from_character", view.clip_from_character));
    draw.uniforms.push_back(gpu::uniform("u_eye", view.eye_in_character));
    draw.uniforms.push_back(gpu::uniform("u_fills", fills));
    device.draw(draw);
  }

 private:
  static BlendPictures picturesOf(const CameraLook& look) { return {.tiled = &look, .size = look.picture_size}; }

  // The closest cameras that have a picture.
  static void choose(FigureState& state, const CameraLook& look, const CharacterView& view,
                     const MethodOptions& options) {
    const int most =
        options.closest == kAllCameras ? kMaxBlendedCameras : std::min(options.closest, kMaxBlendedCameras);
    state.chosen = camerasTowards(look.cameras, viewAxis(view.clip_from_character), kAllCameras);
    std::erase_if(state.chosen, [&](size_t c) { return look.sources[c].source.z <= 0; });
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
    state.fill_geometry = state.regions_serial = 0;
    return {};
  }

  // Near and far plane of each camera's map from the surface's box (OVH03 5.2.3).
  static void setRegions(FigureState& state, const CharacterModel& model, const CameraLook& look) {
    Positions corners;
    const BoundingBox& box = model.frame_bounds;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
    state.regions.clear();
    for (const PinholeCamera& camera : look.cameras) state.regions.push_back(regionOf(camera, corners));
    state.regions_serial = model.geometry_serial;
  }

  static Status fill(gpu::Device& device, FigureState& state, const CharacterModel& model, const CameraLook& look,
                     const MethodOptions& options) {
    if (state.fill_geometry == model.geometry_serial && state.fill_picture == look.serial &&
        state.fill_cameras == state.chosen)
      return {};
    const BlendPictures pictures = picturesOf(look);
    const CameraUniforms cameras(look.cameras, state.chosen, *state.maps, pictures, options.least_cosine);
    FOURDVT_TRY(state.fill.update(device, model, state.chosen.size(), pictures, cameras));
    state.fill_geometry = model.geometry_serial;
    state.fill_picture = look.serial;
    state.fill_cameras = state.chosen;
    return {};
  }

  static std::string definesOf(const FigureState& state, const CameraLook& look, const MethodOptions& options) {
    return CameraUniforms::defines(state.chosen.size(), picturesOf(look)) +
           (options.unseen == Unseen::Neighbourhood ? "FILLED\n" : "");
  }

  Status prepareProgram(gpu::Device& device, const FigureState& state, const CameraLook& look,
                        const MethodOptions& options) {
    const std::string defines = definesOf(state, look, options);
    gpu::Program& program = programs_[defines];
    if (!program) {
      FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", fragment_, defines));
    }
    return {};
  }

  const char* fragment_;
  std::vector<FigureState> figures_;              // by number
  std::map<std::string, gpu::Program> programs_;  // by their defines
};

}  // namespace

Result<std::unique_ptr<Method>> makeCameraMethod(std::string_view name) {
  for (const ShaderOf& shader : kShaders)
    if (shader.method == name) return std::unique_ptr<Method>(std::make_unique<MethodOfShader>(shader.fragment));
  return Error{ErrorId::InvalidArgument, "there is no method " + std::string(name)};
}

}  // namespace fourdvt::render
