// SPDX-License-Identifier: Apache-2.0
// bench_blend_ratio [FRAMES]: milliseconds per frame of a synthetic character of 8000 faces and 3 layers: one member;
// two members blended plainly, with baked alignment, and aligned by optical flow; two looks in a transition.
// Alternating in one run; medians, and ratios to the plain blend of two members.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "or_stop.h"
#include "platform/egl_context.h"
#include "render/recipe.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

constexpr int kRound = 80, kRows = 50, kLayers = 3, kMembers = 2, kCameras = 8, kSide = 512;

// Vase-shaped mesh of a person's size.
package::BaseMesh makeMesh() {
  package::BaseMesh mesh;
  for (int row = 0; row <= kRows; ++row)
    for (int i = 0; i <= kRound; ++i) {
      const float turn = float(2 * M_PI) * float(i) / kRound, height = 1.7f * float(row) / kRows;
      const float radius = 0.25f + 0.06f * std::sin(7 * height);
      mesh.positions.emplace_back(radius * std::sin(turn), height, radius * std::cos(turn));
      mesh.topology.uvs.emplace_back(0.02f + 0.96f * float(i) / kRound, 0.98f - 0.96f * float(row) / kRows);
    }
  for (uint32_t row = 0; row < kRows; ++row)
    for (uint32_t i = 0; i < kRound; ++i) {
      const uint32_t a = row * (kRound + 1) + i, b = a + 1, c = a + kRound + 1;
      mesh.topology.face_vertices.push_back({a, b, c});
      mesh.topology.face_vertices.push_back({b, c + 1, c});
    }
  mesh.topology.face_uvs = mesh.topology.face_vertices;
  mesh.topology.vertex_count = uint32_t(mesh.positions.size());
  return mesh;
}

package::Character makeCharacter(const package::BaseMesh& mesh) {
  package::Character character;
  character.layer_count = kLayers;
  character.vertex_count = mesh.topology.vertex_count;
  character.face_count = mesh.topology.faceCount();
  character.bounds = {{-0.3f, 0, -0.3f}, {0.3f, 1.7f, 0.3f}};
  for (int c = 0; c < kCameras; ++c)
    character.cameras.push_back(cameraFromOrbit({360.0 * c / kCameras, 5, 3, {0, 0.85, 0}, 35}, 720, 960));
  return character;
}

// Labels of each face: its nearest cameras, in an order that differs between members.
std::vector<uint8_t> makeLabels(const package::BaseMesh& mesh, const package::Character& character) {
  const size_t faces = mesh.topology.faceCount();
  std::vector<uint8_t> labels(kMembers * kLayers * faces);
  for (size_t f = 0; f < faces; ++f) {
    const glm::dvec3 at(mesh.positions[mesh.topology.face_vertices[f].x]);
    std::vector<uint8_t> order(kCameras);
    std::iota(order.begin(), order.end(), uint8_t(0));
    const auto distance = [&](uint8_t c) { return glm::distance(character.cameras[c].centreInWorld(), at); };
    std::sort(order.begin(), order.end(), [&](uint8_t a, uint8_t b) { return distance(a) < distance(b); });
    for (int member = 0; member < kMembers; ++member)
      for (int layer = 0; layer < kLayers; ++layer)
        labels[(member * kLayers + layer) * faces + f] = order[(layer + member) % kLayers];
  }
  return labels;
}

class Subject {
 public:
  explicit Subject(gpu::Device& device) {
    const package::BaseMesh mesh = makeMesh();
    const package::Character character = makeCharacter(mesh);
    const std::vector<uint8_t> labels = makeLabels(mesh, character);
    const std::vector<glm::vec2> alignment(mesh.positions.size(), glm::vec2(0.01f, 0.004f));
    model = orStop(render::CharacterModel::create(device, character, mesh));
    model.setPositions(device, mesh.positions);
    package::Rendition rendition;
    rendition.width = kLayers * kSide;
    rendition.height = kMembers * kSide;
    for (int i = 0; i < kMembers * kLayers; ++i)
      rendition.layers.push_back({i % kLayers * kSide, i / kLayers * kSide, kSide, kSide});
    const size_t member_labels = labels.size() / kMembers;
    for (render::Appearance* appearance : {&both, &alone}) {
      const int members = appearance == &both ? kMembers : 1;
      *appearance = orStop(render::Appearance::create(device, model, members));
      appearance->setFrame(device, model,
                           {std::span(labels).first(members * member_labels),
                            std::span(alignment).first(members == 1 ? 0 : alignment.size())});
      rendition.layers.resize(members * kLayers);
      appearance->setLayout(rendition);
      appearance->detail_correlation = 0.8f;  // so that "baked" restores detail, as captured members need
    }
    upload(device, rendition.width, rendition.height);
  }

  render::CharacterModel model;
  render::Appearance both, alone;
  render::PictureTextures picture;

 private:
  void upload(gpu::Device& device, int width, int height) {
    picture = orStop(render::createPicture(device, width, height, render::PictureTextures::Kind::I420));
    std::vector<uint8_t> y(size_t(width) * height), chroma(y.size() / 4, 128);
    for (int row = 0; row < height; ++row)
      for (int x = 0; x < width; ++x)
        y[size_t(row) * width + x] = uint8_t(126 + 60 * std::sin(0.11 * x) * std::cos(0.07 * row + 0.03 * x));
    render::uploadPicture(device, picture,
                          {width, height, y.data(), chroma.data(), chroma.data(), width, width / 2, width / 2});
  }
};

struct Variant {
  const char* name;
  std::vector<render::Look> looks;
  render::Align align;
  std::vector<double> times_ms;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void race(gpu::Device& device, render::Recipe& recipe, const Subject& subject, int width, int height, int frames) {
  static constexpr float kHalves[] = {0.5f, 0.5f}, kWhole[] = {1};
  const render::Look both{&subject.both, &subject.picture, kHalves}, alone{&subject.alone, &subject.picture, kWhole};
  std::vector<Variant> variants = {{"one source", {alone}, render::Align::None, {}},
                                   {"none", {both}, render::Align::None, {}},
                                   {"baked", {both}, render::Align::Baked, {}},
                                   {"flow", {both}, render::Align::Flow, {}},
                                   {"transition", {alone, alone}, render::Align::None, {}}};
  const render::View view = render::viewFromCamera(
      cameraFromOrbit(defaultOrbit(subject.model.bounds, double(width) / height), width, height));
  const auto color = orStop(gpu::makeTexture(device, {.width = width, .height = height, .label = "race"}));
  const auto target = orStop(gpu::makeTarget(device, {.colors = {color.id()}, .label = "race"}));
  for (int i = -2; i < frames; ++i)  // the first ones warm up
    for (Variant& variant : variants) {
      const render::Figure figure{&subject.model, variant.looks, 0.5f};
      const auto start = std::chrono::steady_clock::now();
      orStop(recipe.draw({&figure, 1}, nullptr, view, {{}, variant.align}, target.id()));
      uint8_t pixel[4];  // waits until everything is drawn
      orStop(device.readPixels(target.id(), gpu::PixelFormat::RGBA8,
                               {.x = width / 2, .y = height / 2, .width = 1, .height = 1}, pixel));
      const auto time = std::chrono::steady_clock::now() - start;
      if (i >= 0) variant.times_ms.push_back(std::chrono::duration<double, std::milli>(time).count());
    }
  const double plain = median(variants[1].times_ms);
  for (const Variant& variant : variants)
    std::printf("%4dx%-4d %-11s %8.2f ms  %5.2f\n", width, height, variant.name, median(variant.times_ms),
                median(variant.times_ms) / plain);
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(1, std::atoi(argv[1])) : 40;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const auto recipe = orStop(render::Recipe::create(*device));
  recipe->setFlow(orStop(render::createGpuFlow(*device)));
  const Subject subject(*device);
  std::printf("%s, %u faces, %d layers, %d frames\n", device->caps().renderer.c_str(), subject.model.face_count,
              kLayers, frames);
  race(*device, *recipe, subject, 512, 512, frames);
  race(*device, *recipe, subject, 720, 960, frames);
  return 0;
}
