// SPDX-License-Identifier: Apache-2.0
#include "capture/surface_offsets.h"

#include <gtest/gtest.h>

#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

SurfaceOffsets breathing(uint32_t loop_frames) {
  return {{0}, {0.01f}, {{"walk", {{2, 6}, {{0.002f}, {-0.002f}}, loop_frames}}}};
}

TEST(SurfaceOffsets, SequencesWithoutSlowOffsetsHaveTheConstantOnes) {
  EXPECT_FLOAT_EQ(offsetsAt(breathing(0), "run", 3)[0], 0.01f);
}

TEST(SurfaceOffsets, SlowOffsetsAreLinearInBetweenAndHeldAtTheEnds) {
  const SurfaceOffsets offsets = breathing(0);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 0)[0], 0.012f);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 2)[0], 0.012f);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 3)[0], 0.011f);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 6)[0], 0.008f);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 60)[0], 0.008f);
}

TEST(SurfaceOffsets, LoopsStayLoops) {
  // From frame 6 to frame 2 of the next pass of 8: four frames.
  const SurfaceOffsets offsets = breathing(8);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 7)[0], 0.009f);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 0)[0], 0.01f);
  EXPECT_FLOAT_EQ(offsetsAt(offsets, "walk", 1)[0], 0.011f);
}

TEST(SurfaceOffsets, MeshThatIsCutAlongASeamStaysClosed) {
  // A roof of two quads with separate vertices along the ridge.
  MeshTopology topology;
  topology.vertex_count = 8;
  topology.face_vertices = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const Positions given{{-1, 0, 1}, {0, 1, 1}, {0, 1, -1}, {-1, 0, -1}, {0, 1, 1}, {1, 0, 1}, {1, 0, -1}, {0, 1, -1}};
  SurfaceOffsets offsets;
  offsets.same_as = weldedVertices(given);
  EXPECT_EQ(offsets.same_as, (std::vector<uint32_t>{0, 1, 2, 3, 1, 5, 6, 2}));
  offsets.constant_m = {0.1f, 0.1f, 0.1f, 0.1f, 0.7f, 0.1f, 0.1f, 0.7f};  // values of the copies are ignored
  Positions moved = given;
  addOffsets(offsets, topology, offsetsAt(offsets, "walk", 0), moved);
  EXPECT_EQ(moved[1], moved[4]);
  EXPECT_EQ(moved[2], moved[7]);
  EXPECT_NE(moved[1], given[1]);
}

TEST(SurfaceOffsets, EveryMeshFrameThatIsReadHasThem) {
  const SmallCapture files;
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto offsets = std::make_shared<SurfaceOffsets>();
  offsets->same_as = {0, 1, 2, 3};
  offsets->constant_m.assign(4, 0.25f);
  capture.value().offsets = offsets;
  const auto positions = readMeshFrame(capture.value(), capture.value().sequences[0], 1);
  ASSERT_TRUE(positions.ok());
  for (const glm::vec3& p : positions.value()) EXPECT_NEAR(p.z, 0.1 + 0.25, 1e-6);  // the quad faces +z
}

TEST(ColmapText, ReadsBackWhatWasWritten) {
  CaptureCamera plain, distorted;
  plain.pinhole = {"cam00", 720, 960, 1697.25, 1690.5, 360, 480};
  plain.pinhole.cam_from_world = glm::dmat4(glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0));
  plain.pinhole.cam_from_world[3] = glm::dvec4(0.1, -0.2, 4.5, 1);
  distorted = plain;
  distorted.pinhole.name = "cam01";
  distorted.distortion = {-0.1, 0.02, 0.001, -0.002};
  const ColmapText text = colmapText({plain, distorted}, 0.001);
  auto read = parseColmapText(text.cameras, text.images, "cameras");
  ASSERT_TRUE(read.ok()) << read.error().message;
  scaleToMetres(read.value(), 0.001);
  ASSERT_EQ(read.value().size(), 2u);
  for (size_t c = 0; c < 2; ++c) {
    const CaptureCamera &expected = c ? distorted : plain, &got = read.value()[c];
    EXPECT_EQ(got.pinhole.name, expected.pinhole.name);
    EXPECT_DOUBLE_EQ(got.pinhole.fx, expected.pinhole.fx);
    EXPECT_DOUBLE_EQ(got.pinhole.fy, expected.pinhole.fy);
    EXPECT_DOUBLE_EQ(got.distortion.k1, expected.distortion.k1);
    EXPECT_DOUBLE_EQ(got.distortion.p2, expected.distortion.p2);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        EXPECT_NEAR(got.pinhole.cam_from_world[i][j], expected.pinhole.cam_from_world[i][j], 1e-9);
  }
}

}  // namespace
}  // namespace fourdvt::capture
