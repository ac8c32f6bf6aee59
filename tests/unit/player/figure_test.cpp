// SPDX-License-Identifier: Apache-2.0
// The figure in isolation: uploads of meshes, and mixing of two tracks.
#include "player/parts/figure.h"

#include <gtest/gtest.h>

#include "player_fixture.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

// Two tracks that show frames 2 and 6 of one sequence.
struct TwoTracks {
  TwoTracks() {
    character = package::readManifest(fake.manifest).take();
    EXPECT_TRUE(composer.setMesh(device, character, mesh.decoded).ok());
    index = package::readStreamHeader(header()).take();
    frames = package::decodeChunk(chunk(), index, 0, package::makeChunkMesh(mesh.decoded)).take();
    first.blend({&frames, &index, 2}, motion::memberWeights(character.sequences[0], 0));
    second.blend({&frames, &index, 6}, motion::memberWeights(character.sequences[0], 0));
  }
  std::span<const uint8_t> header() { return std::span(stream()).first(character.sequences[0].stream_header_bytes); }
  std::span<const uint8_t> chunk() {
    return std::span(stream()).subspan(index.chunks[0].offset, index.chunks[0].bytes);
  }
  const std::vector<uint8_t>& stream() { return fake.files.at("walk.bin"); }
  float shownX() const { return composer.model().frame_bounds.min.x; }  // vertex 0's x identifies the frame

  FakeCharacter fake = FakeBuilder().build({{"walk", 8, 8, 25, true, 192, 16}});
  package::EncodedBaseMesh mesh = fakeMesh();
  package::Character character;
  package::StreamIndex index;
  package::ChunkFrames frames;
  std::unique_ptr<gpu::Device> owned = gpu::createNullDevice();
  gpu::Device& device = *owned;
  FigureComposer composer;
  ShownFrame first, second;
};

float tagOf(double frame) { return float(kStep_m * kFrameStride * frame); }

}  // namespace

TEST(PlayerFigure, UploadsTheMeshOnlyWhenItIsStale) {
  TwoTracks s;
  s.composer.compose(s.device, s.first, nullptr, {});
  EXPECT_EQ(s.composer.model().geometry_serial, 0u) << "nobody said that it changed";
  s.composer.markStale();
  s.composer.compose(s.device, s.first, nullptr, {});
  EXPECT_NEAR(s.shownX(), tagOf(2), 1e-6);
  const uint64_t serial = s.composer.model().geometry_serial;
  s.composer.compose(s.device, s.second, nullptr, {});
  EXPECT_EQ(s.composer.model().geometry_serial, serial);
}

TEST(PlayerFigure, MixesTwoTracksByShareAndShift) {
  TwoTracks s;
  for (float share : {0.0f, 0.25f, 1.0f}) {
    s.composer.markStale();
    s.composer.compose(s.device, s.first, &s.second, {share, {0.5f, 0, 0}});
    EXPECT_NEAR(s.shownX(), tagOf(2) + share * (tagOf(6) - tagOf(2) + 0.5f), 1e-5) << share;
  }
}

TEST(PlayerFigure, APresentedFrameIsStaleUntilItIsBlended) {
  TwoTracks s;
  const package::Sequence& sequence = s.character.sequences[0];
  const FrameGeometry geometry{&s.frames, &s.index, 3};
  EXPECT_FALSE(s.first.stale());
  ASSERT_TRUE(
      s.first.present(s.device, s.composer.model(), s.character, sequence, sequence.renditions[0], geometry).ok());
  EXPECT_TRUE(s.first.stale());
  EXPECT_TRUE(s.first.appearance().ready());
  EXPECT_NEAR(s.first.positions()[0].x, tagOf(2), 1e-6) << "the mesh of the frame before";
  s.first.blend(geometry, motion::memberWeights(sequence, 0));
  EXPECT_FALSE(s.first.stale());
  EXPECT_NEAR(s.first.positions()[0].x, tagOf(3), 1e-6);
}

TEST(PlayerFigure, AFigureHasALookOfEachTrackAndStaysValid) {
  TwoTracks s;
  const package::Sequence& sequence = s.character.sequences[0];
  for (ShownFrame* frame : {&s.first, &s.second})
    ASSERT_TRUE(frame
                    ->present(s.device, s.composer.model(), s.character, sequence, sequence.renditions[0],
                              {&s.frames, &s.index, 1})
                    .ok());
  const float weight = 1;
  render::Figure figure;
  {
    const render::Look looks[] = {{&s.first.appearance(), nullptr, {&weight, 1}},
                                  {&s.second.appearance(), nullptr, {&weight, 1}}};
    figure = s.composer.figure(looks, 0.3f, glm::mat4(2));
  }
  ASSERT_EQ(figure.looks.size(), 2u);
  EXPECT_EQ(figure.looks[1].appearance, &s.second.appearance());
  EXPECT_EQ(figure.fade, 0.3f);
  EXPECT_EQ(figure.world_from_character, glm::mat4(2));
  EXPECT_EQ(figure.model, &s.composer.model());
}
