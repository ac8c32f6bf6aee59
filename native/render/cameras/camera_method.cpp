// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/camera_method.h"

#include <map>
#include <string>

#include "render/cameras/figure_cameras.h"
#include "render/cameras/floating.h"
#include "render/cameras/montage.h"
#include "render/cameras/sweep.h"

namespace fourdvt::render {
namespace {

enum class ShaderCameras {
  None,     // the surface alone
  Chosen,   // blends the cameras chosen by the options (camera_shade.glsl)
  Bounded,  // like Chosen, with one more camera that bounds the weights (camera_lumigraph.glsl)
};

// Draws the surface once, with a method's own fragment shader.
class ShaderMethod final : public Method {
 public:
  ShaderMethod(const char* fragment_file, ShaderCameras cameras) : fragment_file_(fragment_file), cameras_(cameras) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.emplace_back();
    if (cameras_ != ShaderCameras::None) {
      MethodOptions chosen = options;
      if (cameras_ == ShaderCameras::Bounded && options.closest > 0) ++chosen.closest;
      FOURDVT_TRY(figures_[number].prepare(device, model, look, view, chosen));
    }
    const std::string defines = definesOf(number, look, options);
    gpu::Program& program = programs_[defines];
    if (!program) {
      FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", fragment_file_, defines));
    }
    return {};
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    gpu::Draw draw = surfaceDraw(model, programs_.at(definesOf(number, look, options)).id());
    if (cameras_ == ShaderCameras::None) {
      draw.uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character),
                       gpu::uniform("u_eye", view.eye_in_character)};
      return device.draw(draw);
    }
    const CameraUniforms cameras = figures_[number].uniforms(look, options);
    cameras.addTo(draw);
    figures_[number].addTo(draw, view, options);
    const float uncertainty_m = model.length_scale * options.depth_uncertainty_m;
    draw.uniforms.push_back(gpu::uniform("u_depth_uncertainty", uncertainty_m));
    device.draw(draw);
  }

 private:
  std::string definesOf(size_t number, const CameraLook& look, const MethodOptions& options) const {
    if (cameras_ == ShaderCameras::None) return {};
    const size_t wanted = static_cast<size_t>(options.closest);
    const bool bounded = cameras_ == ShaderCameras::Bounded && wanted > 0 && figures_[number].chosen().size() > wanted;
    return figures_[number].defines(look, options) + (bounded ? "BOUNDED\n" : "");
  }

  const char* const fragment_file_;
  const ShaderCameras cameras_;
  std::vector<FigureCameras> figures_;            // indexed by figure
  std::map<std::string, gpu::Program> programs_;  // keyed by defines
};

using Made = Result<std::unique_ptr<Method>>;

struct Row {
  const char* name;
  MethodGroup group;
  bool needs_half_float_targets;
  Made (*make)(gpu::Device&, const Row&);
  const char* fragment_file = nullptr;  // for single-shader methods
};

template <ShaderCameras cameras>
Made ofShader(gpu::Device&, const Row& row) {
  return std::unique_ptr<Method>(std::make_unique<ShaderMethod>(row.fragment_file, cameras));
}

Made ofMontage(gpu::Device& device, const Row& row) { return makeMontage(device, row.name); }

template <class Class>
Made ofClass(gpu::Device&, const Row&) {
  return std::unique_ptr<Method>(std::make_unique<Class>());
}

template <FloatingForm form>
Made floating(gpu::Device& device, const Row&) {
  return makeFloating(device, form);
}

Made floatingStatic(gpu::Device& device, const Row&) { return makeFloatingStatic(device); }

constexpr MethodGroup kTextured = MethodGroup::Textured, kInspection = MethodGroup::Inspection;

// Registers all methods.
constexpr Row kRows[] = {
    {kDefaultMethod.data(), kTextured, false, ofClass<Sweep>},
    {"fvvr", kTextured, false, ofShader<ShaderCameras::Chosen>, "camera_fvvr.frag"},
    {"lumigraph", kTextured, false, ofShader<ShaderCameras::Bounded>, "camera_lumigraph.frag"},
    {"filtered", kTextured, false, ofShader<ShaderCameras::Bounded>, "camera_filtered.frag"},
    {"band-limited", kTextured, false, ofShader<ShaderCameras::Bounded>, "camera_band_limited.frag"},
    {"linear", kTextured, true, floating<FloatingForm::Linear>},
    {"floating", kTextured, true, floating<FloatingForm::Mean>},
    {"floating-pairs", kTextured, true, floating<FloatingForm::Pairs>},
    {"floating-static", kTextured, true, floatingStatic},
    {"holoportation", kTextured, false, ofMontage},
    {"montage4d", kTextured, true, ofMontage},
    {"montage4d-seams", kInspection, true, ofMontage},
    {"montage4d-weights", kInspection, true, ofMontage},
    {"wireframe", kInspection, false, ofShader<ShaderCameras::None>, "camera_wireframe.frag"},
    {"silhouette", kInspection, false, ofShader<ShaderCameras::None>, "camera_silhouette.frag"},
};

constexpr const char* kMethodOfEveryDevice = "lumigraph";

bool isKnown(std::string_view name) {
  for (const Row& row : kRows)
    if (row.name == name) return true;
  return false;
}

}  // namespace

std::vector<std::string> cameraMethodNames(MethodGroup group) {
  std::vector<std::string> names;
  for (const Row& row : kRows)
    if (row.group == group) names.emplace_back(row.name);
  return names;
}

Result<std::unique_ptr<Method>> makeCameraMethod(gpu::Device& device, std::string_view name) {
  for (const Row& row : kRows) {
    if (row.name != name) continue;
    if (row.needs_half_float_targets && !device.caps().half_float_targets)
      return Error{ErrorId::Unsupported, "this device cannot draw into half-float textures"};
    return row.make(device, row);
  }
  return Error{ErrorId::InvalidArgument, "there is no method " + std::string(name)};
}

Result<SupportedMethod> makeSupportedMethod(gpu::Device& device, std::string_view name) {
  SupportedMethod out{nullptr, std::string(name), ""};
  auto made = makeCameraMethod(device, name);
  if (made.ok()) {
    out.method = made.take();
    return out;
  }
  if (made.error().id != ErrorId::Unsupported) return made.error();
  out.notice = made.error().message + ": " + kMethodOfEveryDevice + " is drawn in place of " + out.name;
  out.name = kMethodOfEveryDevice;
  FOURDVT_ASSIGN(out.method, makeCameraMethod(device, kMethodOfEveryDevice));
  return out;
}

std::string methodOf(const package::Character& character) {
  return isKnown(character.method.name) ? character.method.name : std::string(kDefaultMethod);
}

Result<SupportedMethod> makeMethodOf(gpu::Device& device, const package::Character& character) {
  FOURDVT_ASSIGN(auto out, makeSupportedMethod(device, methodOf(character)));
  const std::string& wanted = character.method.name;
  if (!wanted.empty() && !isKnown(wanted))
    out.notice = "this player does not know the method " + wanted + ": " + out.name + " is drawn in place of it";
  return out;
}

}  // namespace fourdvt::render
