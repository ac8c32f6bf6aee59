// SPDX-License-Identifier: Apache-2.0
// An AlignmentScene on the GPU: stills at any weights, the aligner's displacements, and their errors against the truth.
#pragma once

#include "alignment_scene.h"
#include "bake/align/surface_alignment.h"

namespace fourdvt::testing {

class AlignmentRig {
 public:
  // Exits if the device fails.
  AlignmentRig(gpu::Device& device, const AlignmentSceneOptions& options)
      : scene(options),
        device_(device),
        model_(render::CharacterModel::create(device, scene.character, scene.mesh).take()),
        appearance_(render::Appearance::create(device, model_, options.members).take()),
        picture_(render::createPicture(device, scene.rendition.width, scene.rendition.height,
                                       render::PictureTextures::Kind::Rgba)
                     .take()),
        recipe_(render::Recipe::create(device).take()) {
    model_.setPositions(device, scene.middle);
    appearance_.setLayout(scene.rendition);
    setAlignment({});
    device.updateTexture(picture_.rgba.id(), {.width = scene.picture.width, .height = scene.picture.height},
                         scene.picture.pixels.data());
  }

  void setAlignment(std::span<const glm::vec2> alignment) {
    appearance_.setFrame(device_, model_, {scene.labels, alignment});
  }
  Result<bake::AlignedFrame> align(const bake::AlignmentOptions& options) {
    auto aligner = bake::SurfaceAligner::create(device_, scene.character, scene.mesh, options);
    if (!aligner) return aligner.error();
    return aligner.value()->align(scene.middle, appearance_, picture_);
  }
  // RGBA on black, top row first.
  Image draw(const PinholeCamera& camera, std::span<const float> weights, render::Align align) {
    const auto color = gpu::makeTexture(device_, {.width = camera.width, .height = camera.height}).take();
    const auto target = gpu::makeTarget(device_, {.colors = {color.id()}}).take();
    const render::Look look{&appearance_, &picture_, weights};
    const render::Figure figure{&model_, std::span(&look, 1)};
    render::DrawOptions options;
    options.align = align;
    options.recipe.ground_shadow = false;
    options.recipe.samples = 0;
    Image image(camera.width, camera.height, 4);
    Status done = recipe_->draw(std::span(&figure, 1), nullptr, render::viewFromCamera(camera), options, target.id());
    if (done)
      done = device_.readPixels(target.id(), gpu::PixelFormat::RGBA8, {.width = camera.width, .height = camera.height},
                                image.pixels.data());
    if (!done) std::fprintf(stderr, "%s\n", done.error().message.c_str()), std::abort();
    return image;
  }
  // View between the aligner's views: `index` 0…5, 360 × 640 pixels.
  PinholeCamera heldOutView(int index) const {
    OrbitView orbit = defaultOrbit(scene.character.bounds, 0.5625);
    orbit.azimuth_deg = 15 + 60 * index;
    orbit.elevation_deg = 12;
    return cameraFromOrbit(orbit, 360, 640);
  }

  AlignmentScene scene;

 private:
  gpu::Device& device_;
  render::CharacterModel model_;
  render::Appearance appearance_;
  render::PictureTextures picture_;
  std::unique_ptr<render::Recipe> recipe_;
};

constexpr int kHeldOutViews = 6;

// Sum of squared differences over the figure, accumulated over pictures.
struct SquaredError {
  double sum = 0;
  size_t count = 0;
  void add(const Image& a, const Image& b) {
    for (size_t i = 0; i < a.pixels.size(); i += 4) {
      if (a.pixels[i + 3] < 255) continue;
      for (int c = 0; c < 3; ++c, ++count) sum += std::pow(double(a.pixels[i + c]) - b.pixels[i + c], 2);
    }
  }
  double psnr_db() const { return 10 * std::log10(255.0 * 255 * double(count) / std::max(sum, 1e-9)); }
};

// RMS distance between found and true displacement, over textured vertices away from the ends, metres.
inline double alignmentError_m(const AlignmentScene& scene, std::span<const glm::vec2> found) {
  const std::vector<glm::vec2> truth = scene.truth();
  double sum = 0;
  int count = 0;
  for (uint32_t v = 0; v < truth.size(); ++v) {
    const double share = scene.heightShare(v);
    if (share < 0.1 || share > 0.9 || scene.isPlain(share)) continue;
    const glm::dvec2 error = found[v] - truth[v];
    sum += glm::dot(error, error);
    ++count;
  }
  return std::sqrt(sum / count);
}

}  // namespace fourdvt::testing
