// SPDX-License-Identifier: Apache-2.0
#include "bake/align/looks.h"

#include <opencv2/imgproc.hpp>

namespace fourdvt::bake {
namespace {

constexpr float kNeighbourhood = 0.03f;  // side of the window of local contrast, in picture heights
constexpr float kLeastContrast = 8;      // grey: deviation at which texture starts to count
constexpr float kContrast = 40;          // grey: deviation of textured places in the result

class Drawer final : public LookDrawer {
 public:
  Drawer(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh,
         std::unique_ptr<render::Recipe> recipe)
      : device_(device), character_(character), mesh_(mesh), recipe_(std::move(recipe)) {
    options_.align = render::Align::None;
    options_.recipe.ground_shadow = false;
    options_.recipe.samples = 0;  // the mesh's outline is the same in all looks
  }

  Status setFrame(const Positions& positions, const std::vector<std::vector<glm::vec2>>& member_uvs) override {
    models_.clear();
    for (const std::vector<glm::vec2>& uvs : member_uvs) {
      mesh_.topology.uvs = uvs;
      FOURDVT_ASSIGN(auto model, render::CharacterModel::create(device_, character_, mesh_));
      models_.push_back(std::move(model));
      models_.back().setPositions(device_, positions);
    }
    return {};
  }

  Result<std::vector<cv::Mat>> draw(const PinholeCamera& camera, const render::Appearance& appearance,
                                    const render::PictureTextures& picture) override {
    FOURDVT_TRY(resize(camera.width, camera.height));
    std::vector<cv::Mat> looks;
    for (size_t member = 0; member < models_.size(); ++member) {
      std::vector<float> weights(models_.size(), 0.0f);
      weights[member] = 1;
      const render::Look look{&appearance, &picture, weights};
      const render::Figure figure{&models_[member], std::span(&look, 1)};
      FOURDVT_TRY(
          recipe_->draw(std::span(&figure, 1), nullptr, render::viewFromCamera(camera), options_, target_.id()));
      cv::Mat rgba(camera.height, camera.width, CV_8UC4);
      FOURDVT_TRY(device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8,
                                     {.width = camera.width, .height = camera.height}, rgba.data));
      looks.push_back(rgba);
    }
    return looks;
  }

 private:
  Status resize(int width, int height) {
    if (color_ && width == width_ && height == height_) return {};
    target_.reset();
    FOURDVT_ASSIGN(color_, gpu::makeTexture(device_, {.width = width, .height = height, .label = "alignment look"}));
    FOURDVT_ASSIGN(target_, gpu::makeTarget(device_, {.colors = {color_.id()}, .label = "alignment look"}));
    width_ = width;
    height_ = height;
    return {};
  }

  gpu::Device& device_;
  const package::Character& character_;
  package::BaseMesh mesh_;  // a copy: its texture vertices move
  std::unique_ptr<render::Recipe> recipe_;
  render::DrawOptions options_;
  std::vector<render::CharacterModel> models_;  // one a member
  gpu::Texture color_;
  gpu::Target target_;
  int width_ = 0, height_ = 0;
};

}  // namespace

cv::Mat evenLuma(const cv::Mat& rgba) {
  const int side = int(kNeighbourhood * float(rgba.rows)) | 1;
  const cv::Size window(side, side);
  cv::Mat luma, alpha, inside, share, mean, variance, even;
  cv::cvtColor(rgba, luma, cv::COLOR_RGBA2GRAY);
  cv::extractChannel(rgba, alpha, 3);
  luma.convertTo(luma, CV_32F);
  alpha.convertTo(inside, CV_32F, 1.0 / 255);
  cv::blur(inside, share, window);
  share += 1e-6;
  cv::blur(luma.mul(inside), mean, window);
  const cv::Mat deviation = (luma - mean / share).mul(inside);
  cv::blur(deviation.mul(deviation), variance, window);
  cv::sqrt(variance / share, variance);
  cv::Mat(deviation / (variance + kLeastContrast) * kContrast + 128).convertTo(even, CV_8U);
  return even;
}

Result<std::unique_ptr<LookDrawer>> LookDrawer::create(gpu::Device& device, const package::Character& character,
                                                       const package::BaseMesh& mesh) {
  FOURDVT_ASSIGN(auto recipe, render::Recipe::create(device));
  return std::unique_ptr<LookDrawer>(std::make_unique<Drawer>(device, character, mesh, std::move(recipe)));
}

}  // namespace fourdvt::bake
