// SPDX-License-Identifier: Apache-2.0
#include "package/sound.h"

#include <gtest/gtest.h>

#include "manifest_fixture.h"

using namespace fourdvt;
using namespace fourdvt::package;
using fourdvt::testing::flatten;
using fourdvt::testing::kAt;
using fourdvt::testing::smallCharacter;
using fourdvt::testing::smallMesh;
using nlohmann::json;

namespace {

TEST(SoundManifest, RoundTripsAndEveryWrongFieldIsRefused) {
  const EncodedBaseMesh mesh = smallMesh();
  Character character = smallCharacter(mesh);
  const Sounds sounds = {{character.sequences[0].name,
                          {48000, 2, 4.5, {{"walk.webm", 30, 0x1234, "audio/webm", 312, {{10, 200}, {20, 300}}}}, {}}}};
  const json gltf = json::parse(writeManifest({character, &mesh, "", "fourdvt test", "nobody", sounds}).take());
  EXPECT_TRUE(readManifest(flatten(gltf)).ok());
  const auto read = readSound(flatten(gltf), 0);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().channels, 2);
  EXPECT_EQ(read.value().segment_s, 4.5);
  ASSERT_EQ(read.value().encodings.size(), 1u);
  EXPECT_EQ(read.value().encodings[0].uri, "walk.webm");
  EXPECT_EQ(read.value().encodings[0].hash, 0x1234u);
  EXPECT_EQ(read.value().encodings[0].priming, 312u);
  ASSERT_EQ(read.value().encodings[0].segments.size(), 2u);
  EXPECT_EQ(read.value().encodings[0].segments[1].samples, 300u);
  EXPECT_TRUE(readSound(flatten(gltf), 1).value().encodings.empty());
  const std::string at = kAt + "/sequences/0/sound";
  for (const auto& [field, wrong] :
       std::vector<std::pair<std::string, json>>{{"/sampleRate", 10},
                                                 {"/channels", 3},
                                                 {"/segmentDuration", 0},
                                                 {"/encodings", json::array()},
                                                 {"/encodings/0/uri", "../a.webm"},
                                                 {"/encodings/0/byteLength", 31},
                                                 {"/encodings/0/type", ""},
                                                 {"/encodings/0/priming", -1},
                                                 {"/encodings/0/segments/0", json::array({10})},
                                                 {"/encodings/0/segments/0/0", 0},
                                                 {"/steps", json::array({2})}}) {
    json changed = gltf;
    changed[json::json_pointer(at + field)] = wrong;
    const auto refused = readSound(flatten(changed), 0);
    ASSERT_FALSE(refused.ok()) << field;
    EXPECT_EQ(refused.error().id, ErrorId::ManifestInvalid);
  }
}

}  // namespace
