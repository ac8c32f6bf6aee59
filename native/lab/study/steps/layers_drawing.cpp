// SPDX-License-Identifier: Apache-2.0
#include "lab/study/steps/layers_drawing.h"

#include <algorithm>
#include <cmath>

#include "bake/run/character_files.h"
#include "lab/study/run/scene.h"
#include "measure/metrics.h"

namespace fourdvt::study {
namespace {

constexpr int kGain = 4, kMargin = 8;

// Colour map of black, red, yellow, white.
void heat(double value, uint8_t* rgb) {
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<uint8_t>(std::clamp(3 * value - 255.0 * c, 0.0, 255.0));
}

package::Character characterOf(const bake::Job& job, int layers) {
  package::Character character = bake::describeCharacter(job);
  character.layer_count = layers;
  return character;
}

constexpr int kLayerColumns = 3;

package::Rect rectOf(int layer, int size) {
  return {layer % kLayerColumns * size, layer / kLayerColumns * size, size, size};
}

// Layout of layers in a grid of three columns.
package::Rendition gridOf(int size, int max_layers, int layers) {
  package::Rendition rendition;
  rendition.width = std::min(kLayerColumns, max_layers) * size;
  rendition.height = (max_layers + kLayerColumns - 1) / kLayerColumns * size;
  for (int l = 0; l < layers; ++l) rendition.layers.push_back(rectOf(l, size));
  return rendition;
}

}  // namespace

Result<std::unique_ptr<LayerDrawing>> LayerDrawing::create(gpu::Device& device, const bake::Job& job, int size,
                                                           int max_layers) {
  const int largest = device.caps().max_texture_size;
  const package::Rendition grid = gridOf(size, max_layers, max_layers);
  if (std::max(grid.width, grid.height) > largest)
    return Error{ErrorId::GpuFailure, std::to_string(max_layers) + " layers of " + std::to_string(size) +
                                          " texels are larger than this GPU's largest texture of " +
                                          std::to_string(largest) + "; use a GPU with larger textures"};
  std::unique_ptr<LayerDrawing> out(new LayerDrawing(device, job, size));
  out->max_layers_ = max_layers;
  FOURDVT_ASSIGN(out->recipe_, render::Recipe::create(device));
  FOURDVT_ASSIGN(out->picture_,
                 render::createPicture(device, grid.width, grid.height, render::PictureTextures::Kind::Rgba));
  return out;
}

Result<render::PlainFigure*> LayerDrawing::figureOf(int layers) {
  auto it = figures_.find(layers);
  if (it == figures_.end()) {
    FOURDVT_ASSIGN(auto figure, render::PlainFigure::create(device_, characterOf(job_, layers), job_.mesh.decoded));
    figure.setLayout(gridOf(size_, max_layers_, layers));
    it = figures_.emplace(layers, std::move(figure)).first;
  }
  return &it->second;
}

Status LayerDrawing::setGeometry(const Positions& positions, const std::vector<uint8_t>& labels, int layers) {
  FOURDVT_ASSIGN(auto figure, figureOf(layers));
  figure->setFrame(device_, positions, labels);
  return {};
}

Status LayerDrawing::show(const std::vector<Image>& layers) {
  for (size_t l = 0; l < layers.size(); ++l) {
    if (layers[l].channels != 4 || layers[l].width != size_ || layers[l].height != size_)
      return Error{ErrorId::Internal, "a layer to draw is not RGBA of the drawing's size"};
    const package::Rect rect = rectOf(static_cast<int>(l), size_);
    device_.updateTexture(picture_.rgba.id(), {.x = rect.x, .y = rect.y, .width = size_, .height = size_},
                          layers[l].pixels.data());
  }
  return {};
}

Result<Image> LayerDrawing::draw(const PinholeCamera& camera, int layers) {
  FOURDVT_ASSIGN(auto figure, figureOf(layers));
  const render::View view = render::viewFromCamera(camera);
  return still_.render(
      view, [&](gpu::TargetId target) { return figure->draw(*recipe_, picture_, view, studyRecipe(), target); });
}

Result<uint64_t> LayerDrawing::gpuBytes(int layers) {
  const uint64_t before = device_.counters().live_texture_bytes;
  FOURDVT_ASSIGN(auto figure, render::PlainFigure::create(device_, characterOf(job_, layers), job_.mesh.decoded));
  FOURDVT_ASSIGN(auto picture,
                 render::createPicture(device_, size_ * layers, size_, render::PictureTextures::Kind::I420));
  return device_.counters().live_texture_bytes - before;
}

Image errorMap(const Image& reference, const Image& picture) {
  const Image a = measure::compositedOnBlack(reference), b = measure::compositedOnBlack(picture);
  const measure::Mask inside = measure::unionOfSilhouettes(reference, picture);
  int x0 = a.width, y0 = a.height, x1 = 0, y1 = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (!inside[static_cast<size_t>(y) * a.width + x]) continue;
      x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
    }
  if (x0 >= x1) x0 = y0 = 0, x1 = a.width, y1 = a.height;
  x0 = std::max(0, x0 - kMargin), y0 = std::max(0, y0 - kMargin);
  x1 = std::min(a.width, x1 + kMargin), y1 = std::min(a.height, y1 + kMargin);
  const int width = x1 - x0;
  Image out(3 * width, y1 - y0, 3);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const uint8_t *p = a.at(x, y), *q = b.at(x, y);
      double difference = 0;
      for (int c = 0; c < 3; ++c) difference += std::abs(p[c] - q[c]) / 3.0;
      std::copy_n(p, 3, out.at(x - x0, y - y0));
      std::copy_n(q, 3, out.at(width + x - x0, y - y0));
      heat(kGain * difference, out.at(2 * width + x - x0, y - y0));
    }
  return out;
}

}  // namespace fourdvt::study
