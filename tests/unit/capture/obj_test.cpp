// SPDX-License-Identifier: Apache-2.0
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

TEST(CaptureObj, PolygonsBecomeFansAndUvsFlip) {
  auto mesh =
      parseObj("v 0 0 0\r\nv 1 0 0\nv 1 1 0\nv +.0 1.5e0 0\nvt 0 0.25\nvt 1 0\nvt 1 1 0\nf 1/1/1 2/2 3/3 4/1", "a");
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  const MeshTopology& t = mesh.value().topology;
  EXPECT_EQ(t.vertex_count, 4u);
  ASSERT_EQ(t.faceCount(), 2u);
  EXPECT_EQ(t.face_vertices[0], glm::uvec3(0, 1, 2));
  EXPECT_EQ(t.face_vertices[1], glm::uvec3(0, 2, 3));
  EXPECT_EQ(t.face_uvs[1], glm::uvec3(0, 2, 0));
  EXPECT_EQ(t.uvs[0], glm::vec2(0, 0.75f));
  EXPECT_EQ(t.uvs[2], glm::vec2(1, 0));
  EXPECT_EQ(mesh.value().positions[3], glm::vec3(0, 1.5f, 0));
}

TEST(CaptureObj, LinesMayContinueAndAMarkMayStandBefore) {
  const std::string plain = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\n";
  for (const char* end : {"\n", "\r\n"}) {
    const std::string more = std::string("\\") + end;
    auto mesh =
        parseObj("\xef\xbb\xbf" + plain + "f 1/1 " + more + "2/1" + more + more + " 3/1\nv 5 " + more + "5 5\n", "a");
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    EXPECT_EQ(mesh.value().topology.face_vertices[0], glm::uvec3(0, 1, 2));
    ASSERT_EQ(mesh.value().positions.size(), 4u);
    EXPECT_EQ(mesh.value().positions[3], glm::vec3(5, 5, 5));
    expectError(parseObj(plain + "f 1/1 " + more + "2/1 " + more + "3/1\nf 1/1 2/1 9/1\n", "a"), ErrorId::MeshIndex,
                "a:8");
  }
  EXPECT_TRUE(parseObj(plain + "f 1/1 2/1 3/1 \\", "a").ok()) << "at the end of the file";
}

// A polygon may be convex at one instant and concave at another: it keeps the triangles of the given mesh.
TEST(CaptureObj, PolygonsAreSplitAsBefore) {
  const std::string flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", dart = "v 0 0 0\nv 1 0 0\nv 0.2 0.2 0\nv 0 1 0\n",
                    rest = "v 9 9 9\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n", quad = "f 2/2 3/3 4/4 1/1\n";
  const auto before = parseObj(flat + rest + quad, "a"), alone = parseObj(dart + rest + quad, "a");
  ASSERT_TRUE(before.ok() && alone.ok());
  const MeshTopology& as = before.value().topology;
  EXPECT_EQ(as.face_vertices, (std::vector<glm::uvec3>{{1, 2, 3}, {1, 3, 0}}));
  EXPECT_EQ(alone.value().topology.face_vertices, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  const auto after = parseObj(dart + rest + quad, "a", &as),
             back = parseObj(flat + rest + quad, "a", &alone.value().topology);
  ASSERT_TRUE(after.ok() && back.ok());
  EXPECT_EQ(after.value().topology.face_vertices, as.face_vertices);
  EXPECT_EQ(after.value().topology.face_uvs, as.face_uvs);
  EXPECT_EQ(back.value().topology.face_vertices, alone.value().topology.face_vertices);
  EXPECT_EQ(back.value().topology.face_uvs, alone.value().topology.face_uvs);
  for (const std::string other : {"f 2/2 3/3 5/4 1/1\n", "f 2/2 3/3 4/1 1/1\n", "f 2/2 3/3 4/4\n"}) {
    const auto differs = parseObj(flat + rest + other, "a", &as);
    ASSERT_TRUE(differs.ok());
    EXPECT_NE(std::tie(differs.value().topology.face_vertices, differs.value().topology.face_uvs),
              std::tie(as.face_vertices, as.face_uvs));
  }
}

TEST(CaptureObj, NegativeIndicesCountBack) {
  auto mesh = parseObj("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf -3/-1 -2/-1 -1/-1\nv 5 5 5\n", "a");
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh.value().topology.face_vertices[0], glm::uvec3(1, 2, 3));
}

TEST(CaptureObj, RejectsBadFiles) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\n", vt = "vt 0 0\n";
  auto check = [](const std::string& text, ErrorId id) { expectError(parseObj(text, "x.obj"), id, "x.obj"); };
  check(v + "f 1 2 3\n", ErrorId::MeshNoUvs);
  check(v + vt + "f 1 2 3\n", ErrorId::MeshNoUvs);
  check(v + vt + "f 1//1 2//1 3//1\n", ErrorId::MeshNoUvs);
  check("v nan 0 0\n" + v + vt + "f 1/1 2/1 3/1\n", ErrorId::MeshNotFinite);
  check("v 0 inf 0\n" + v + vt + "f 1/1 2/1 3/1\n", ErrorId::MeshNotFinite);
  check("v 0 1\n" + v + vt + "f 1/1 2/1 3/1\n", ErrorId::MeshNotFinite);
  check(v + "vt nan 0\nf 1/1 2/1 3/1\n", ErrorId::MeshNotFinite);
  check(v + vt + "f 1/1 2/1 4/1\n", ErrorId::MeshIndex);
  check(v + vt + "f 0/1 2/1 3/1\n", ErrorId::MeshIndex);
  check(v + vt + "f 1/2 2/1 3/1\n", ErrorId::MeshIndex);
  check(v + vt + "f -4/1 2/1 3/1\n", ErrorId::MeshIndex);
  check(v + vt + "f 99999999999999999999/1 2/1 3/1\n", ErrorId::MeshIndex);
  check(v + vt + "f 1/1 2/1\n", ErrorId::MeshIndex);
  check(v + vt, ErrorId::MeshIndex);
  check("", ErrorId::MeshIndex);
  check(v + "vt 1.2 0\nf 1/1 2/1 3/1\n", ErrorId::MeshUvRange);
  check(v + "vt 0 -0.5\nf 1/1 2/1 3/1\n", ErrorId::MeshUvRange);
}

TEST(CaptureObj, MessageNamesTheLine) {
  expectError(parseObj("v 0 0 0\nv 0 0 0\nvt 2 0\n", "x.obj"), ErrorId::MeshUvRange, "x.obj:3: ");
}

}  // namespace
}  // namespace fourdvt::capture
