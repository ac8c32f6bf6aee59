// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/floating.h"

#include <algorithm>

#include "render/cameras/floating_pictures.h"
#include "render/cameras/surface_picture.h"
#include "render/flow/flow.h"

namespace fourdvt::render {
namespace {

using gpu::PixelFormat;
constexpr int kLeastSide = 32;   // pixels of a view; flow needs more than a patch
constexpr int kStarOctaves = 1;  // the star's flow has half the view's size
constexpr const char* kPictureNames[] = {"u_picture_0", "u_picture_1", "u_picture_2", "u_picture_3"};
constexpr const char* kFlowNames[] = {"u_flow_0", "u_flow_1", "u_flow_2", "u_flow_3"};

class Floating final : public Method {
 public:
  Floating(FloatingForm form, std::unique_ptr<FlowSource> flow) : form_(form), flow_(std::move(flow)) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.emplace_back();
    Figure& figure = figures_[number];
    FOURDVT_TRY(surface_.prepare(device));
    FOURDVT_TRY(figure.cameras.prepare(device, model, look, view, options, FloatingPictures::kMost));
    FOURDVT_TRY(pictures_.update(device, model, look, view, options, figure.cameras));
    FOURDVT_TRY(resizeGroup(device, view.width, view.height, {PixelFormat::RGBA8}, false, figure.shown));
    if (form_ == FloatingForm::Linear || pictures_.count() == 1 || std::min(view.width, view.height) < kLeastSide)
      return blend(device, false, figure.shown);
    for (size_t i = 0; i <= kScratch; ++i)
      if (i < pictures_.count() || (i == kScratch && form_ == FloatingForm::Pairs))
        FOURDVT_TRY(resizeGroup(device, view.width, view.height, {PixelFormat::RG16F}, false, flows_[i]));
    FOURDVT_TRY(form_ == FloatingForm::Pairs ? floatPairs(device) : floatToMean(device, figure.shown, options));
    return blend(device, true, figure.shown);
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    surface_.draw(device, model, view, figures_[number].shown.textures[0].id());
  }

 private:
  struct Figure {
    FigureCameras cameras;
    PictureGroup shown;
  };

  Status compute(gpu::TextureId a, gpu::TextureId b, int octaves) {
    return flow_->compute(a, b, flows_[0].width >> octaves, flows_[0].height >> octaves);
  }

  Status floatPairs(gpu::Device& device) {
    const size_t n = pictures_.count();
    for (size_t i = 0; i < n; ++i) {
      // Sums go to and fro, so that the last one lands in the picture's own.
      const PictureGroup* to = (n - 1) % 2 == 1 ? &flows_[i] : &flows_[kScratch];
      gpu::TextureId before = 0;
      for (size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        FOURDVT_TRY(compute(pictures_.picture(i), pictures_.picture(j), 0));
        FOURDVT_TRY(sum_.draw(device, {flow_->flow(), pictures_.weights(), int(j), before, kMostBetweenPictures},
                              to->target.id()));
        before = to->textures[0].id();
        to = to == &flows_[i] ? &flows_[kScratch] : &flows_[i];
      }
    }
    return {};
  }

  Status floatToMean(gpu::Device& device, PictureGroup& mean, const MethodOptions& options) {
    for (int round = 0; round < std::max(options.floating.rounds, 1); ++round) {
      FOURDVT_TRY(blend(device, round > 0, mean));
      for (size_t i = 0; i < pictures_.count(); ++i) {
        FOURDVT_TRY(compute(mean.textures[0].id(), pictures_.picture(i), kStarOctaves));
        FOURDVT_TRY(sum_.draw(device, {.flow = flow_->flow(), .weights = pictures_.weights(), .most = kMostFromMean},
                              flows_[i].target.id()));
      }
    }
    return {};
  }

  Status blend(gpu::Device& device, bool warped, const PictureGroup& to) {
    const size_t n = pictures_.count();
    std::string defines = "CAMERAS " + std::to_string(n) + "\n";
    if (warped) defines += form_ == FloatingForm::Pairs ? "WARPED\nPAIRS\n" : "WARPED\n";
    gpu::Program& program = blend_programs_[defines];
    if (!program) {
      FOURDVT_ASSIGN(program,
                     makeCameraProgram(device, "camera_fullscreen.vert", "camera_floating_blend.frag", defines));
    }
    gpu::Draw draw{.program = program.id(), .textures = {{"u_weights", pictures_.weights()}}, .vertex_count = 3};
    for (size_t i = 0; i < n; ++i) {
      draw.textures.push_back({kPictureNames[i], pictures_.picture(i)});
      if (warped) draw.textures.push_back({kFlowNames[i], flows_[i].textures[0].id()});
    }
    device.beginPass({.target = to.target.id(), .label = "blend"});
    device.draw(draw);
    device.endPass();
    return {};
  }

  static constexpr size_t kScratch = FloatingPictures::kMost;
  const FloatingForm form_;
  std::unique_ptr<FlowSource> flow_;
  std::vector<Figure> figures_;  // by number
  FloatingPictures pictures_;
  PictureGroup flows_[FloatingPictures::kMost + 1];  // by rank, and scratch
  FlowSum sum_;
  std::map<std::string, gpu::Program> blend_programs_;  // by their defines
  SurfacePicture surface_;
};

}  // namespace

Result<std::unique_ptr<Method>> makeFloating(gpu::Device& device, FloatingForm form) {
  FOURDVT_ASSIGN(auto flow,
                 createGpuFlow(device, form == FloatingForm::Star ? floatingFlow(kStarOctaves, kExplainsFromMean)
                                                                  : floatingFlow(0, kExplainsBetweenPictures)));
  return std::unique_ptr<Method>(std::make_unique<Floating>(form, std::move(flow)));
}

}  // namespace fourdvt::render
