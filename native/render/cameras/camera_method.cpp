// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/camera_method.h"

#include <map>
#include <string>

#include "render/cameras/figure_cameras.h"

namespace fourdvt::render {
namespace {

struct ShaderOf {
  std::string_view method;
  const char* fragment;
  bool textured;  // from the cameras' pictures
};
constexpr ShaderOf kShaders[] = {{"fvvr", "camera_fvvr.frag", true},
                                 {"wireframe", "camera_wireframe.frag", false},
                                 {"silhouette", "camera_silhouette.frag", false}};

// A method that is one draw of the surface with its own fragment shader.
class MethodOfShader final : public Method {
 public:
  explicit MethodOfShader(const ShaderOf& shader) : shader_(shader) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.emplace_back();
    if (shader_.textured) FOURDVT_TRY(figures_[number].prepare(device, model, look, view, options));
    const std::string defines = definesOf(number, look, options);
    gpu::Program& program = programs_[defines];
    if (!program) {
      FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", shader_.fragment, defines));
    }
    return {};
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    gpu::Draw draw = surfaceDraw(model, programs_.at(definesOf(number, look, options)).id());
    if (!shader_.textured) {
      draw.uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character),
                       gpu::uniform("u_eye", view.eye_in_character)};
      return device.draw(draw);
    }
    const CameraUniforms cameras = figures_[number].uniforms(look, options);
    cameras.addTo(draw);
    figures_[number].addTo(draw, view, options);
    device.draw(draw);
  }

 private:
  std::string definesOf(size_t number, const CameraLook& look, const MethodOptions& options) const {
    return shader_.textured ? figures_[number].defines(look, options) : "";
  }

  const ShaderOf shader_;
  std::vector<FigureCameras> figures_;            // by number
  std::map<std::string, gpu::Program> programs_;  // by their defines
};

}  // namespace

Result<std::unique_ptr<Method>> makeCameraMethod(gpu::Device&, std::string_view name) {
  for (const ShaderOf& shader : kShaders)
    if (shader.method == name) return std::unique_ptr<Method>(std::make_unique<MethodOfShader>(shader));
  return Error{ErrorId::InvalidArgument, "there is no method " + std::string(name)};
}

}  // namespace fourdvt::render
