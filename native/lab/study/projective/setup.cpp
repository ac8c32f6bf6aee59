// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/setup.h"

#include <algorithm>

#include "bake/texels/picture_crop.h"
#include "render/cameras/camera_method.h"

namespace fourdvt::study {
namespace {

// Borrowed method for the stage, which owns its methods.
class Borrowed final : public render::Method {
 public:
  explicit Borrowed(std::shared_ptr<render::Method> method) : method_(std::move(method)) {}
  Status prepare(gpu::Device& device, size_t number, const render::CharacterModel& model,
                 const render::CameraLook& look, const render::CharacterView& view,
                 const render::MethodOptions& options) override {
    return method_->prepare(device, number, model, look, view, options);
  }
  void draw(gpu::Device& device, size_t number, const render::CharacterModel& model, const render::CameraLook& look,
            const render::CharacterView& view, const render::MethodOptions& options) const override {
    method_->draw(device, number, model, look, view, options);
  }

 private:
  std::shared_ptr<render::Method> method_;
};

void keepWithin(Image& picture, const Image& truth) {
  for (size_t i = 3; i < picture.pixels.size(); i += 4)
    picture.pixels[i] = std::min(picture.pixels[i], truth.pixels[i]);
}

}  // namespace

Result<MethodChoice> chooseMethods(gpu::Device& device, const std::vector<std::string>& asked) {
  MethodChoice out;
  for (const std::string& name : asked.empty() ? allMethods() : asked) {
    const auto method = render::makeCameraMethod(device, name);
    if (method.ok()) {
      out.methods.push_back(name);
      continue;
    }
    const Error& error = method.error();
    if (error.id != ErrorId::Unsupported) return error;
    out.left_out.push_back(name + ": " + error.message);
  }
  return out;
}

Image inputTruth(Image picture) {
  bake::replaceEdgeColours(picture);
  return picture;
}

ProjectiveSetup::ProjectiveSetup(const StudyContext& context, gpu::Device& device)
    : context_(context), device_(device), proxies_(*context.capture, *context.device, context.work() + "/surfaces") {}

Result<std::unique_ptr<ProjectiveSetup>> ProjectiveSetup::create(const StudyContext& context, gpu::Device& device) {
  std::unique_ptr<ProjectiveSetup> out(new ProjectiveSetup(context, device));
  for (const capture::CaptureCamera& camera : context.capture->cameras) out->cameras_.push_back(camera.pinhole);
  FOURDVT_ASSIGN(out->test_cameras_, capture::readTestCameras(*context.capture));
  FOURDVT_ASSIGN(auto choice, chooseMethods(device, context.options.methods));
  out->methods_ = std::move(choice.methods);
  FOURDVT_ASSIGN(out->stage_, bake::FrameDrawing::create(device, out->cameras_));
  return out;
}

std::vector<std::string> ProjectiveSetup::methodsOf(const Condition& condition) const {
  if (condition.all_methods) return methods_;
  std::vector<std::string> out;
  for (const std::string& name : axisMethods())
    if (std::find(methods_.begin(), methods_.end(), name) != methods_.end()) out.push_back(name);
  return out;
}

Result<FrameScene> ProjectiveSetup::scene(const Condition& condition, FrameWindow& frames, uint32_t frame) {
  FrameScene out;
  out.plane = condition.proxy == rows::kProxyPlane;
  FOURDVT_ASSIGN(out.surface, proxies_.surface(out.plane ? rows::kProxyGiven : condition.proxy, frames, frame));
  if (condition.errors.proxy_mm > 0) out.surface = stoodOff(std::move(out.surface), condition.errors.proxy_mm);
  FOURDVT_ASSIGN(const auto* captured, frames.at(frame));
  out.pictures = withGains(captured->pictures, condition);
  return out;
}

Status ProjectiveSetup::show(const Condition& condition, const FrameScene& scene, const PinholeCamera& view) {
  // Keeps the model while the surface keeps its topology, as in playback.
  if (shown_ != condition.name()) stage_->setCameras(miscalibrated(cameras_, condition));
  shown_ = condition.name();
  return stage_->setFrame(scene.plane ? facingPlane(scene.surface.positions, view) : scene.surface, scene.pictures);
}

Result<std::map<std::string, ProjectiveSetup::Shared>> ProjectiveSetup::make(const std::vector<std::string>& names) {
  std::map<std::string, Shared> out;
  for (const std::string& name : names) {
    FOURDVT_ASSIGN(auto method, render::makeCameraMethod(device_, name));
    out[name] = std::move(method);
  }
  return out;
}

Result<Image> ProjectiveSetup::draw(const Shared& method, const Condition& condition, const FrameScene& scene,
                                    const PinholeCamera& view, const Image& truth, float elapsed_s) {
  render::MethodOptions options;
  options.closest = condition.closest;
  options.elapsed_s = elapsed_s;
  stage_->setMethod(std::make_unique<Borrowed>(method));
  FOURDVT_ASSIGN(auto picture, stage_->render(view, options));
  if (scene.plane) keepWithin(picture, truth);
  return picture;
}

}  // namespace fourdvt::study
