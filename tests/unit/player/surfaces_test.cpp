// SPDX-License-Identifier: Apache-2.0
// Characters from cameras in the player's parts: inputs of the recipe for a shown frame, and data from the manifest.
#include <gtest/gtest.h>

#include "camera_character.h"
#include "player/parts/figure.h"
#include "player/parts/loading.h"
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

struct OneGop {
  explicit OneGop(bool constant_topology) {
    const auto encoded = package::encodeSurfaceChunk(tilesOfAGop(1), surfacesOfAGop(constant_topology));
    EXPECT_TRUE(encoded.ok());
    bytes = encoded.value().bytes;
    character.vertex_count = index.vertex_count = encoded.value().vertex_count;
    character.face_count = index.face_count = encoded.value().face_count;
    index.frame_count = 4;
    index.position_origin = kSurfaceOrigin_m;
    index.position_step_m = kSurfaceStep_m;
    index.chunks = {{0, 4, 0, uint32_t(bytes.size())}};
    package::Sequence& s = character.sequences[0];
    s.renditions = {{.width = 160, .height = 100}};
    s.renditions[0].tiles = {16, 4, 128, 96};  // layout of 64 × 48 texels at twice its size
    chunk = package::SurfaceChunk::open(bytes, index, 0, character, s).take();
    EXPECT_TRUE(chunk->decodeTo(3).ok());
    composer.setModel(render::CharacterModel::createForSurfaces(device, character).take());
  }
  void show(uint32_t frame) {
    const FrameGeometry geometry{nullptr, &index, frame, chunk.get()};
    const package::Sequence& s = character.sequences[0];
    EXPECT_TRUE(shown.present(device, composer.model(), character, s, s.renditions[0], geometry).ok());
    EXPECT_TRUE(shown.stale());
    shown.blend(geometry, {});
    composer.markStale();
    composer.compose(device, shown, nullptr, {});
  }

  package::Character character = surfaceCharacter();
  package::StreamIndex index;
  std::vector<uint8_t> bytes;
  std::unique_ptr<package::SurfaceChunk> chunk;
  std::unique_ptr<gpu::Device> owned = gpu::createNullDevice();
  gpu::Device& device = *owned;
  FigureComposer composer;
  ShownFrame shown;
};

}  // namespace

TEST(PlayerSurfaces, EachFramesSurfaceReachesTheModel) {
  OneGop s(false);
  for (uint32_t frame : {2u, 0u, 3u}) {
    s.show(frame);
    const package::Surface surface = s.chunk->surface(frame);
    EXPECT_EQ(s.composer.model().face_count, surface.faces.size());
    EXPECT_EQ(s.composer.model().vertex_count, surface.positions.size());
    EXPECT_TRUE(s.composer.model().closed_surface);
  }
  EXPECT_EQ(s.device.takeErrors(), "");
}

TEST(PlayerSurfaces, AConstantTopologyIsUploadedOnce) {
  OneGop s(true);
  s.show(0);
  const uint64_t topology = s.composer.model().topology_serial, geometry = s.composer.model().geometry_serial;
  s.show(1);
  EXPECT_EQ(s.composer.model().topology_serial, topology);
  EXPECT_GT(s.composer.model().geometry_serial, geometry);
}

// The first camera's tile, x 8…30 and y 4…48 of the layout, is scaled by 2 and lies at (16, 4) of 160 × 100 texels.
TEST(PlayerSurfaces, TilesAreScaledIntoThePicture) {
  OneGop s(false);
  s.show(1);
  const render::PictureTextures picture;
  const render::Figure figure = s.composer.cameraFigure(s.shown, picture, glm::mat4(1));
  ASSERT_NE(figure.cameras, nullptr);
  const render::CameraLook& look = *figure.cameras;
  ASSERT_EQ(look.sources.size(), 2u);
  EXPECT_EQ(look.sources[0].source, glm::vec4(28, 18, 44, 88));
  EXPECT_EQ(look.sources[0].tile, glm::vec4(32, 12, 44, 88) / glm::vec4(160, 100, 160, 100));
  EXPECT_EQ(look.sources[1].source.z, 0) << "this GOP has no picture of the second camera";
  EXPECT_EQ(look.cameras.size(), 2u);
  EXPECT_EQ(look.picture, &picture);
  const uint64_t serial = look.serial;
  s.show(2);
  EXPECT_NE(s.composer.cameraFigure(s.shown, picture, glm::mat4(1)).cameras->serial, serial);
}

// Without a base mesh file; GOP 1 has no picture of the second camera.
TEST(PlayerSurfaces, ACharacterFromCamerasPlaysWithoutABaseMesh) {
  SimulatedEdge edge(fakeCameraCharacter(), {});
  ASSERT_TRUE(edge.load());
  edge.player->play();
  EXPECT_TRUE(edge.runUntil([&] { return edge.player->stats().frames_shown >= 20; })) << "two and a half loops";
  EXPECT_TRUE(edge.errors.empty());
  const render::Figure figure = edge.player->figure().value();
  ASSERT_NE(figure.cameras, nullptr);
  EXPECT_EQ(figure.cameras->sources.size(), 2u);
  EXPECT_GT(figure.model->face_count, 0u);
  const render::View view = render::viewFromCamera(cameraFromOrbit({}, 32, 32));
  EXPECT_EQ(edge.player->draw(view, {}, 0).error().id, ErrorId::Unsupported) << "nobody has given it a method";
}

TEST(PlayerSurfaces, ADamagedChunkIsOneErrorThatNamesTheFile) {
  FakeCharacter character = fakeCameraCharacter();
  std::vector<uint8_t>& stream = character.files.at("turn.bin");
  stream.back() ^= 0xff;
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.player->loadManifest(character.manifest).ok());
  EXPECT_TRUE(edge.runUntil([&] { return !edge.errors.empty(); }));
  EXPECT_EQ(edge.errors.size(), 1u);
  EXPECT_EQ(edge.errors[0].id, ErrorId::FilesDiffer);
  EXPECT_NE(edge.errors[0].message.find("turn.bin"), std::string::npos);
}
