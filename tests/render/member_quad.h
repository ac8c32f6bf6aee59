// SPDX-License-Identifier: Apache-2.0
// A class of motions on the hand-made quad: every member has its own labels, and its own tiles in one picture.
#pragma once

#include "expected.h"
#include "gl_fixture.h"

namespace fourdvt::testing {

// Quad of ±1 m round (0, 1, 0): one metre is half of the texture. Must be destroyed before the device.
struct MemberQuad {
  static constexpr int kSide = 64;
  Scene scene;
  render::CharacterModel model;
  render::Appearance appearance;
  render::PictureTextures picture;

  // label(member, rank): label of both faces.
  template <class LabelOf>
  MemberQuad(gpu::Device& device, int members, int layers, const LabelOf& label) : scene(quadScene({0, 1}, 1.0f)) {
    scene.setLayers(members * layers, kSide);
    scene.character.layer_count = layers;
    for (int rank = 0; rank < members * layers; ++rank)
      for (uint32_t face = 0; face < 2; ++face) scene.setLabel(rank, face, label(rank / layers, rank % layers));
    model = render::CharacterModel::create(device, scene.character, scene.mesh).take();
    model.setPositions(device, scene.mesh.positions);
    appearance = render::Appearance::create(device, model, members).take();
    appearance.setLayout(scene.rendition);
    align(device, {});
    picture = render::createPicture(device, scene.rendition.width, scene.rendition.height,
                                    render::PictureTextures::Kind::Rgba)
                  .take();
  }

  // Sets one displacement for all vertices, per member except the first; none: not aligned.
  void align(gpu::Device& device, const std::vector<glm::vec2>& displacements_m) {
    std::vector<glm::vec2> all;
    for (const glm::vec2& d : displacements_m) all.insert(all.end(), scene.mesh.positions.size(), d);
    appearance.setFrame(device, model, {scene.labels, all});
  }

  // color(tile, u, v): colour at the texel whose centre has u, v in the tile.
  template <class Color>
  void paint(gpu::Device& device, const Color& color) {
    Image image(scene.rendition.width, scene.rendition.height, 4, 255);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const glm::dvec3 c = color(x / kSide, (x % kSide + 0.5) / kSide, (y + 0.5) / kSide);
        for (int i = 0; i < 3; ++i) image.at(x, y)[i] = static_cast<uint8_t>(c[i] + 0.5);
      }
    device.updateTexture(picture.rgba.id(), {.width = image.width, .height = image.height}, image.pixels.data());
  }
  void paintTiles(gpu::Device& device, const std::vector<glm::dvec3>& colors) {
    paint(device, [&](int tile, double, double) { return colors[tile]; });
  }

  render::Look look(std::span<const float> weights) const { return {&appearance, &picture, weights}; }
};

// Texture coordinates of the quad that pixel (x, y) shows.
inline glm::dvec2 uvAt(const PinholeCamera& view, int x, int y) {
  const glm::dvec3 p = pointOnPlane(view, x, y);
  return {(p.x + 1) / 2, (2 - p.y) / 2};
}

}  // namespace fourdvt::testing
