// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/shader_method.h"

#include <map>
#include <string>

#include "render/cameras/figure_cameras.h"

namespace fourdvt::render {
namespace {

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
  std::vector<FigureCameras> figures_;            // by number
  std::map<std::string, gpu::Program> programs_;  // by their defines
};

}  // namespace

std::unique_ptr<Method> makeShaderMethod(const char* fragment_file, ShaderCameras cameras) {
  return std::make_unique<ShaderMethod>(fragment_file, cameras);
}

}  // namespace fourdvt::render
