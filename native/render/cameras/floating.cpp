// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/floating.h"

#include <algorithm>

#include "render/cameras/floating_star.h"
#include "render/cameras/surface_picture.h"
#include "render/flow/flow.h"

namespace fourdvt::render {
namespace {

using gpu::PixelFormat;
constexpr int kLeastSide = 64;  // pixels of a view; below, flow at a quarter of its size has too little to go by

class Floating final : public Method {
 public:
  explicit Floating(FloatingForm form) : form_(form) {}
  Status create(gpu::Device& device) {
    if (form_ == FloatingForm::Star) {
      FOURDVT_ASSIGN(star_, FloatingStar::create(device));
    } else if (form_ == FloatingForm::Pairs) {
      FOURDVT_ASSIGN(pairs_, createGpuFlow(device, floatingFlow(FloatingFlow::Pictures, 0)));
    }
    return {};
  }

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.emplace_back();
    Figure& figure = figures_[number];
    FOURDVT_TRY(surface_.prepare(device));
    FOURDVT_TRY(figure.cameras.prepare(device, model, look, view, options, FloatingPictures::kMost));
    FOURDVT_TRY(pictures_.update(device, model, look, view, options, figure.cameras));
    FOURDVT_TRY(resizeGroup(device, view.width, view.height, {PixelFormat::RGBA8}, false, figure.shown));
    using Warp = PictureBlend::Warp;
    if (form_ == FloatingForm::Linear || pictures_.count() == 1 || std::min(view.width, view.height) < kLeastSide)
      return blend_.draw(device, {pictures_.weights(), pictures_.all()}, Warp::None, figure.shown);
    const bool is_star = form_ == FloatingForm::Star;
    FOURDVT_TRY(is_star ? star_.update(device, pictures_, blend_) : floatPairs(device));
    return blend_.draw(device, {pictures_.weights(), pictures_.all(), is_star ? star_.flows() : pairFlows()},
                       is_star ? Warp::Star : Warp::Pairs, figure.shown);
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

  std::vector<gpu::TextureId> pairFlows() const {
    std::vector<gpu::TextureId> out;
    for (size_t i = 0; i < pictures_.count(); ++i) out.push_back(flows_[i].textures[0].id());
    return out;
  }

  Status floatPairs(gpu::Device& device) {
    const size_t n = pictures_.count();
    for (size_t i = 0; i <= kScratch; ++i)
      if (i < n || i == kScratch)
        FOURDVT_TRY(resizeGroup(device, pictures_.width(), pictures_.height(), {PixelFormat::RG16F}, false, flows_[i]));
    for (size_t i = 0; i < n; ++i) {
      // Sums go to and fro, so that the last one lands in the picture's own.
      const PictureGroup* to = (n - 1) % 2 == 1 ? &flows_[i] : &flows_[kScratch];
      gpu::TextureId before = 0;
      for (size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        FOURDVT_TRY(pairs_->compute(pictures_.picture(i), pictures_.picture(j), flows_[0].width, flows_[0].height));
        FOURDVT_TRY(sum_.draw(device, {pairs_->flow(), pictures_.weights(), int(j), before, kMostBetweenPictures},
                              to->target.id()));
        before = to->textures[0].id();
        to = to == &flows_[i] ? &flows_[kScratch] : &flows_[i];
      }
    }
    return {};
  }

  static constexpr size_t kScratch = FloatingPictures::kMost;
  const FloatingForm form_;
  FloatingStar star_;                  // of the star form
  std::unique_ptr<FlowSource> pairs_;  // of the pairs
  std::vector<Figure> figures_;        // by number
  FloatingPictures pictures_;
  PictureGroup flows_[FloatingPictures::kMost + 1];  // of the pairs by rank, and scratch
  FlowSum sum_;
  PictureBlend blend_;
  SurfacePicture surface_;
};

}  // namespace

Result<std::unique_ptr<Method>> makeFloating(gpu::Device& device, FloatingForm form) {
  auto out = std::make_unique<Floating>(form);
  FOURDVT_TRY(out->create(device));
  return std::unique_ptr<Method>(std::move(out));
}

}  // namespace fourdvt::render
