// SPDX-License-Identifier: Apache-2.0
// The manifest's method of a character from cameras.
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

TEST(Manifest, TheMethodRoundTripsAndIsOptional) {
  const EncodedBaseMesh mesh = smallMesh();
  Character character = smallCharacter(mesh);
  character.appearance = AppearanceKind::Cameras;
  character.version = kCameraFormatVersion;
  character.graph_uri.clear();
  character.sequences.resize(1);
  Sequence& s = character.sequences[0];
  s.members.clear();
  s.layout_width = s.layout_height = 64;
  for (Rendition& rendition : s.renditions) rendition.layers.clear(), rendition.tiles = {0, 0, 64, 64};
  const auto written = [&] {
    return json::parse(writeManifest({character, &mesh, "", "fourdvt test", "nobody"}).take());
  };
  json gltf = written();
  EXPECT_FALSE(gltf.at(json::json_pointer(kAt)).contains("method"));
  auto read = readManifest(flatten(gltf));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().method.name, "");
  EXPECT_EQ(read.value().method.sweep_band_m, 0);
  character.method.name = "fvvr";
  EXPECT_EQ(readManifest(flatten(written())).take().method.name, "fvvr");
  EXPECT_EQ(readManifest(flatten(written())).take().method.sweep_band_m, 0);
  character.method = {"sweep", 0.064};
  gltf = written();
  EXPECT_EQ(readManifest(flatten(gltf)).take().method.name, "sweep");
  EXPECT_EQ(readManifest(flatten(gltf)).take().method.sweep_band_m, 0.064);
  const auto with = [&](const char* field, const json& value) {
    json changed = gltf;
    changed[json::json_pointer(kAt + "/method/" + field)] = value;
    return readManifest(flatten(changed));
  };
  EXPECT_EQ(with("name", "of-a-later-version").take().method.name, "of-a-later-version") << "the player decides";
  for (const json& wrong : {json(""), json(3), json("Sweep"), json("a b"), json(std::string(65, 'a'))})
    EXPECT_EQ(with("name", wrong).error().id, ErrorId::ManifestInvalid) << wrong;
  for (const json& wrong : {json(0), json(-1), json(2), json("wide")})
    EXPECT_EQ(with("sweepBand", wrong).error().id, ErrorId::ManifestInvalid) << wrong;
  gltf[json::json_pointer(kAt)]["method"].erase("name");
  EXPECT_EQ(readManifest(flatten(gltf)).error().id, ErrorId::ManifestInvalid);
}

}  // namespace
