// SPDX-License-Identifier: Apache-2.0
// Corners that can share a vertex shader's work, computed by hand and on a mesh with seams.
#include "render/shared_corners.h"

#include <gtest/gtest.h>

#include "../../render/mannequin.h"

namespace fourdvt::render {
namespace {

using List = std::vector<uint32_t>;

// A fan of three faces round vertex 0; its third face has other texture coordinates there.
const std::vector<glm::uvec3> kFan = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}, kFanUvs = {{0, 1, 2}, {0, 2, 3}, {5, 3, 4}};

List shared(const std::vector<glm::uvec3>& uvs, const List& labels) {
  List out;
  shareCorners(cornersBefore(uvs, 6), kFan, labels, out);
  return out;
}

TEST(SharedCorners, findsTheCornerBeforeWithTheSameTextureCoordinates) {
  EXPECT_EQ(cornersBefore(kFan, 5), (List{0, 1, 2, 0, 2, 5, 3, 5, 8}));
  EXPECT_EQ(cornersBefore(kFanUvs, 6), (List{0, 1, 2, 0, 2, 5, 6, 5, 8}));
}

TEST(SharedCorners, cornersOfAVertexShareUnlessTextureCoordinatesDiffer) {
  EXPECT_EQ(shared(kFan, {7, 7, 7}), (List{0, 1, 2, 0, 2, 5, 0, 5, 8}));
  EXPECT_EQ(shared(kFanUvs, {7, 7, 7}), (List{0, 1, 2, 0, 2, 5, 6, 5, 8}));
}

TEST(SharedCorners, onlyFacesWithTheSameLabelsOfAllMembersShare) {
  EXPECT_EQ(shared(kFan, {7, 8, 7}), (List{0, 1, 2, 3, 4, 5, 0, 7, 8}));  // across a face with other labels
  EXPECT_EQ(shared(kFan, {7, 7, 7, /*member 1*/ 1, 2, 2}), (List{0, 1, 2, 3, 4, 5, 3, 5, 8}));
}

// Vertices must match, too: hand-made meshes may use one texture coordinate for several vertices.
TEST(SharedCorners, verticesWithTheSameTextureCoordinatesDoNotShare) {
  const std::vector<glm::uvec3> uvs(3, glm::uvec3(0, 1, 2));
  EXPECT_EQ(shared(uvs, {7, 7, 7}), (List{0, 1, 2, 0, 4, 5, 0, 7, 8}));
}

TEST(SharedCorners, facesKeepTheirVerticesTextureCoordinatesAndLabels) {
  const testing::Mannequin mannequin(2000);
  const MeshTopology& t = mannequin.scene.mesh.topology;
  const size_t faces = t.faceCount();
  List labels(faces), shared;
  for (size_t f = 0; f < faces; ++f) labels[f] = mannequin.scene.labels[f];
  shareCorners(cornersBefore(t.face_uvs, t.uvs.size()), t.face_vertices, labels, shared);
  ASSERT_EQ(shared.size(), 3 * faces);
  size_t shaded = 0;
  for (uint32_t c = 0; c < shared.size(); ++c) {
    const uint32_t s = shared[c];
    shaded += s == c;
    ASSERT_EQ(shared[s], s);
    ASSERT_EQ(t.face_vertices[s / 3][int(s % 3)], t.face_vertices[c / 3][int(c % 3)]);
    ASSERT_EQ(t.face_uvs[s / 3][int(s % 3)], t.face_uvs[c / 3][int(c % 3)]);
    ASSERT_EQ(labels[s / 3], labels[c / 3]);
  }
  EXPECT_LT(shaded, 3 * faces / 2);  // of 3 * faces
}

}  // namespace
}  // namespace fourdvt::render
