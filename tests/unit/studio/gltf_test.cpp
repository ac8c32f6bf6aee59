// SPDX-License-Identifier: Apache-2.0
// The studio's actors from glTF models, valid and invalid ones.
#include <cmath>

#include "capture_fixture.h"
#include "lab/studio/actors/actor.h"
#include "studio_model.h"

namespace fourdvt::studio {
namespace {

using fourdvt::testing::StudioModel;

class StudioGltf : public ::testing::Test {
 protected:
  Result<std::unique_ptr<Actor>> open(const std::vector<std::string>& motions = {}) {
    path_ = model.write(folder_ / "model.glb");
    return openGltfActor(path_, motions);
  }
  void expectError(ErrorId id, const std::string& part) {
    const auto actor = open();
    capture::expectError(actor, id, path_);
    if (actor.ok()) return;
    EXPECT_NE(actor.error().message.find(part), std::string::npos) << actor.error().message;
  }
  capture::TempFolder folder_;
  std::string path_;
  StudioModel model;
};

// The upper vertices rotate about (0, 0.5, 0); the lower half stays.
glm::dvec3 bent(const glm::dvec3& rest, double degrees) {
  if (rest.y <= 0.5 + 1e-6) return rest;
  const double a = glm::radians(degrees), y = rest.y - 0.5;
  return {rest.x, 0.5 + y * std::cos(a) - rest.z * std::sin(a), y * std::sin(a) + rest.z * std::cos(a)};
}

TEST_F(StudioGltf, IsWeldedTexturedAndPosed) {
  auto opened = open({"bend", "still", "stride", "fall"});
  ASSERT_TRUE(opened) << opened.error().message;
  Actor& actor = *opened.value();
  EXPECT_EQ(actor.surface().topology.vertex_count, 4u * StudioModel::kRings);  // the seam's column is welded
  EXPECT_EQ(actor.surface().topology.faceCount(), 8u * (StudioModel::kRings - 1));
  EXPECT_EQ(actor.texture().at(10, 20)[0], 40);
  EXPECT_EQ(actor.texture().at(10, 20)[1], 80);
  const auto& motions = actor.motions();
  ASSERT_EQ(motions.size(), 4u);
  EXPECT_TRUE(motions[0].loop && motions[1].loop && motions[2].loop);
  EXPECT_FALSE(motions[3].loop);
  EXPECT_NEAR(motions[3].duration_s, 0.8, 1e-6);
  EXPECT_NEAR(motions[2].root_velocity_mps.z, 1.5, 1e-5);
  Positions pose;
  const Positions& rest = actor.surface().positions;
  actor.pose(std::vector<double>{1, 0, 0, 0}, 0.5, pose);
  for (size_t v = 0; v < pose.size(); ++v) ASSERT_NEAR(glm::distance(glm::dvec3(pose[v]), bent(rest[v], 80)), 0, 1e-5);
  // Half-way between bend and still: half the angle, not the mean of the vertices.
  actor.pose(std::vector<double>{0.5, 0.5, 0, 0}, 0.5, pose);
  for (size_t v = 0; v < pose.size(); ++v) ASSERT_NEAR(glm::distance(glm::dvec3(pose[v]), bent(rest[v], 40)), 0, 1e-5);
  // Travel is removed.
  actor.pose(std::vector<double>{0, 0, 1, 0}, 0.5, pose);
  for (size_t v = 0; v < pose.size(); ++v) ASSERT_NEAR(glm::distance(glm::dvec3(pose[v]), bent(rest[v], 40)), 0, 1e-5);
}

TEST_F(StudioGltf, SeveralMaterialsShareAnAtlas) {
  tinygltf::Material red;
  red.pbrMetallicRoughness.baseColorFactor = {1, 0, 0, 1};
  model.gltf.materials.push_back(red);
  model.gltf.meshes[0].primitives.push_back(model.primitive());
  model.gltf.meshes[0].primitives[1].material = 1;
  auto opened = open({"bend"});
  ASSERT_TRUE(opened) << opened.error().message;
  const Image& atlas = opened.value()->texture();
  const MeshTopology& t = opened.value()->surface().topology;
  EXPECT_EQ(t.vertex_count, 4u * StudioModel::kRings);
  const auto colourOf = [&](uint32_t face) {
    glm::vec2 uv(0);
    for (int k = 0; k < 3; ++k) uv += t.uvs[t.face_uvs[face][k]] / 3.0f;
    return atlas.at(int(uv.x * atlas.width), int(uv.y * atlas.height));
  };
  EXPECT_EQ(colourOf(0)[2], 90);
  EXPECT_EQ(colourOf(t.faceCount() - 1)[0], 255);
  EXPECT_EQ(colourOf(t.faceCount() - 1)[2], 0);
}

TEST_F(StudioGltf, BrokenModelsAreNamedWithTheRemedy) {
  capture::expectError(openGltfActor(folder_ / "none.glb", {}), ErrorId::FileMissing, folder_ / "none.glb");
  folder_.write("text.glb", std::string("this is no model"));
  capture::expectError(openGltfActor(folder_ / "text.glb", {}), ErrorId::FileUnreadable, folder_ / "text.glb");
}

TEST_F(StudioGltf, NoTextureCoordinates) {
  model.primitive().attributes.erase("TEXCOORD_0");
  expectError(ErrorId::MeshNoUvs, "unwrap");
}

TEST_F(StudioGltf, RepeatedTexture) {
  auto* uvs = reinterpret_cast<float*>(
      &model.gltf.buffers[0].data[model.gltf.bufferViews[model.gltf.accessors[model.uv].bufferView].byteOffset]);
  uvs[0] = 2.5f;
  expectError(ErrorId::MeshUvRange, "[0,1]");
}

TEST_F(StudioGltf, NoSkin) {
  model.gltf.nodes[2].skin = -1;
  expectError(ErrorId::Unsupported, "armature");
}

TEST_F(StudioGltf, NoWeights) {
  model.primitive().attributes.erase("WEIGHTS_0");
  expectError(ErrorId::Unsupported, "WEIGHTS_0");
}

TEST_F(StudioGltf, NoAnimation) {
  model.gltf.animations.clear();
  expectError(ErrorId::Unsupported, "animation");
}

TEST_F(StudioGltf, NoSuchAnimationListsThose) {
  const auto actor = open({"walk"});
  capture::expectError(actor, ErrorId::InvalidArgument, path_);
  EXPECT_NE(actor.error().message.find("bend, stride"), std::string::npos) << actor.error().message;
}

TEST_F(StudioGltf, JointOutOfRange) {
  model.gltf.skins[0].joints.pop_back();
  expectError(ErrorId::MeshIndex, "joint");
}

TEST_F(StudioGltf, AccessorBeyondItsBuffer) {
  model.gltf.accessors[model.position].count = 1000000;
  const auto actor = open();
  capture::expectError(actor, ErrorId::FileUnreadable, path_);
}

}  // namespace
}  // namespace fourdvt::studio
