// SPDX-License-Identifier: Apache-2.0
// Which corners share a vertex shader's work, by hand and on a mesh with seams.
#include "render/shared_corners.h"

#include <gtest/gtest.h>

#include "../../render/mannequin.h"

namespace fourdvt::render {
namespace {

using List = std::vector<uint32_t>;

// A fan of three faces round vertex 0; its third face has other texture coordinates.
const std::vector<glm::uvec3> kFan = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}, kFanUvs = {{0, 1, 2}, {0, 2, 3}, {5, 6, 4}};

TEST(SharedCorners, cornersOfAVertexAreOne) {
  EXPECT_EQ(cornersBefore(kFan, {}, 5), (List{0, 1, 2, 0, 2, 5, 3, 5, 8}));
  EXPECT_EQ(firstCorners(cornersBefore(kFan, {}, 5)), (List{0, 1, 2, 0, 2, 5, 0, 5, 8}));
}

TEST(SharedCorners, otherTextureCoordinatesAreOtherCorners) {
  EXPECT_EQ(cornersBefore(kFan, kFanUvs, 5), (List{0, 1, 2, 0, 2, 5, 6, 7, 8}));
}

TEST(SharedCorners, onlyFacesWithTheSameLabelsOfAllMembersShare) {
  const List before = cornersBefore(kFan, {}, 5);
  List shared;
  shareCorners(before, List{7, 7, 7}, shared);
  EXPECT_EQ(shared, (List{0, 1, 2, 0, 2, 5, 0, 5, 8}));
  shareCorners(before, List{7, 8, 7}, shared);
  EXPECT_EQ(shared, (List{0, 1, 2, 3, 4, 5, 0, 7, 8}));  // past a face with other labels
  shareCorners(before, List{7, 7, 7, /*member 1*/ 1, 2, 2}, shared);
  EXPECT_EQ(shared, (List{0, 1, 2, 3, 4, 5, 3, 5, 8}));
}

TEST(SharedCorners, facesKeepTheirVerticesTextureCoordinatesAndLabels) {
  const testing::Mannequin mannequin(2000);
  const MeshTopology& t = mannequin.scene.mesh.topology;
  const size_t faces = t.faceCount();
  List labels(faces), shared;
  for (size_t f = 0; f < faces; ++f) labels[f] = mannequin.scene.labels[f];
  shareCorners(cornersBefore(t.face_vertices, t.face_uvs, t.vertex_count), labels, shared);
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
