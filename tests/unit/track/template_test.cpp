// SPDX-License-Identifier: Apache-2.0
#include "track/template.h"

#include <gtest/gtest.h>

#include "implicit_mesh.h"
#include "reconstruct/mesh_checks.h"
#include "track/mesh/atlas.h"
#include "track/mesh/genus_zero.h"

namespace fourdvt::testing {
namespace {

using track::fitnessOf;
using track::GenusZeroSurface;
using track::TemplateFitness;
using track::templateMesh;
using track::templateProblem;
using track::View;

// Trunk and two arms; `hands`: distance of the hands from the hips; `elbows`: from the middle.
TriangleMesh figureWithHandsAt(float hands, float elbows = 0.5f) {
  const auto arm = [&](float side) {
    const glm::vec3 elbow(side * elbows, 0.2f, 0), hand(side * (0.16f + hands), -0.1f, 0);
    return joint(capsule({side * 0.12f, 0.4f, 0}, elbow, 0.05f), capsule(elbow, hand, 0.05f));
  };
  return meshOf(joint(capsule({0, -0.3f, 0}, {0, 0.4f, 0}, 0.15f), joint(arm(-1), arm(1))), glm::vec3(-0.9f),
                glm::vec3(0.9f), 0.03f);
}

std::vector<View> ringOfViews() {
  std::vector<View> out;
  for (int c = 0; c < 6; ++c) {
    View& view = out.emplace_back();
    view.camera = cameraFromOrbit({60.0 * c, 10, 3.5, {0, 0, 0}, 32}, 240, 240);
    view.grey = cv::Mat(240, 240, CV_8UC1, cv::Scalar(128));
    view.matte = cv::Mat(240, 240, CV_8UC1, cv::Scalar(255));
  }
  return out;
}

TemplateFitness fitnessAt(float hands, float elbows = 0.5f) {
  const auto closed = track::genusZeroSurface(figureWithHandsAt(hands, elbows), 0.01);
  EXPECT_TRUE(closed.ok());
  const GenusZeroSurface& s = closed.value();
  return fitnessOf(s.mesh, s.cut_m3, s.other_m3, ringOfViews());
}

TEST(TemplateFrame, LimbsApartAreBetterThanArmsAlongTheTrunk) {
  const TemplateFitness apart = fitnessAt(0.2f), along = fitnessAt(0.0f, 0.16f);
  EXPECT_EQ(apart.cut_share, 0);
  EXPECT_GT(apart.limbs_m, along.limbs_m + 0.6);
  EXPECT_GT(apart.score(), along.score() + 0.6);
  EXPECT_EQ(templateProblem(apart, 0.99, true), "");
}

TEST(TemplateFrame, AGivenOneHasNoHandsOnHips) {
  const TemplateFitness touching = fitnessAt(0.0f);
  EXPECT_GT(touching.cut_share, 0);
  EXPECT_NE(templateProblem(touching, 0.99, true).find("hands on hips"), std::string::npos);
  EXPECT_EQ(templateProblem(touching, 0.99, false), "");
}

TEST(TemplateFrame, OtherProblemsHaveARemedy) {
  TemplateFitness fitness{1.5, 2, 0, 0, 3};
  EXPECT_NE(templateProblem(fitness, 0.4, false).find("fourdvt reconstruct"), std::string::npos);
  fitness.other_share = 0.5;
  EXPECT_NE(templateProblem(fitness, 0.99, false).find("one performer"), std::string::npos);
  fitness = {0.9, 2, 0, 0, 3};
  EXPECT_NE(templateProblem(fitness, 0.99, false).find("at least half"), std::string::npos);
}

TEST(TemplateMesh, HasTheWantedFacesAndAnAtlas) {
  const auto closed = track::genusZeroSurface(figureWithHandsAt(0.2f), 0.01);
  ASSERT_TRUE(closed.ok());
  const auto made = templateMesh(closed.value().mesh, ringOfViews(), {3000, 512, 10});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const auto& [topology, positions] = made.value();
  EXPECT_NEAR(topology.faceCount(), 3000, 60);
  EXPECT_EQ(topology.vertex_count, positions.size());
  EXPECT_EQ(reconstruct::checkMesh({positions, topology.face_vertices}).euler, 2);
  const track::AtlasQuality quality = track::atlasQuality(topology, positions, 512);
  EXPECT_EQ(quality.flipped_faces, 0u);
  EXPECT_EQ(quality.overlapping_texels, 0u);
  EXPECT_LT(quality.stretch_l2, 1.2);
}

}  // namespace
}  // namespace fourdvt::testing
