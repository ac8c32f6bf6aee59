// SPDX-License-Identifier: Apache-2.0
// The room's picture on boxes with cameras that see one colour each: means, excluded pixels, feathering, the fill.
#include "bake/room/room.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "package/character.h"

namespace fourdvt::bake {
namespace {

constexpr int kSide = 64;
const BoundingBox kBox{{-2, 0, -2}, {2, 3, 2}};

// Plate of one colour from (x, 1, z), looking horizontally along -z or, turned, along +z; 90 degrees wide and high.
RoomPlate painted(double x, double z, bool turned, const glm::u8vec3& paint) {
  RoomPlate plate;
  plate.camera.width = plate.camera.height = kSide;
  plate.camera.fx = plate.camera.fy = plate.camera.cx = plate.camera.cy = kSide / 2.0;
  const double s = turned ? 1 : -1;
  // Rows: right, down, forward.
  const glm::dmat3 rotation = glm::transpose(glm::dmat3({-s, 0, 0}, {0, -1, 0}, {0, 0, s}));
  plate.camera.cam_from_world = glm::dmat4(rotation);
  plate.camera.cam_from_world[3] = glm::dvec4(-(rotation * glm::dvec3(x, 1, z)), 1);
  plate.picture = Image(kSide, kSide, 4, 255);
  for (size_t i = 0; i < plate.picture.pixels.size(); ++i)
    if (i % 4 != 3) plate.picture.pixels[i] = paint[int(i % 4)];
  return plate;
}

const glm::dvec3 kBackWall(0, 1, -2), kFromBackWall(0, 0, 1);

RoomLookup::Seen look(const std::vector<RoomPlate>& plates, RoomBlend blend, const glm::dvec3& point = kBackWall,
                      const glm::dvec3& inward = kFromBackWall, double feather = 0.25) {
  return RoomLookup(plates, {blend, feather}).at(point, inward);
}

void expectColour(const glm::vec3& colour, const glm::vec3& levels) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(255 * colour[c], levels[c], 0.01) << "channel " << c;
}

const std::vector<RoomPlate> kThree{painted(-0.2, 1, false, {30, 0, 255}), painted(0.2, 1, false, {60, 0, 255}),
                                    painted(0, 1.5, false, {100, 0, 255})};

TEST(Room, MeanIsExact) {
  expectColour(look({kThree[0]}, RoomBlend::Mean).colour, {30, 0, 255});
  expectColour(look({kThree[0], kThree[1]}, RoomBlend::Mean).colour, {45, 0, 255});
  const RoomLookup::Seen all = look(kThree, RoomBlend::Mean);
  expectColour(all.colour, {190 / 3.0, 0, 255});
  EXPECT_EQ(all.cameras, 3);
}

TEST(Room, RecurrenceIsOnlyNearlyTheMean) {
  const double two = 30 + 0.56 * 30, three = two + 0.34 * (100 - two);
  expectColour(look(kThree, RoomBlend::Recurrence).colour, {three, 0, 255});
}

TEST(Room, ColoursAreCorrectedBeforeTheyAreMixed) {
  std::vector<RoomPlate> plates{kThree[0], kThree[1]};
  plates[0].colour_matrix = glm::mat3(2);
  plates[1].colour_offset = {0, 0.2f, 0};
  expectColour(look(plates, RoomBlend::Mean).colour, {60, 25.5f, 382.5f});
}

TEST(Room, NothingFromBehindACameraOrAFace) {
  const RoomPlate away = painted(0, 1, true, {255, 255, 255});
  EXPECT_EQ(look({away}, RoomBlend::Mean).cameras, 0);
  expectColour(look({kThree[0], away}, RoomBlend::Mean).colour, {30, 0, 255});
  // A camera outside the room faces the near wall's back, and the inner side of the opposite wall.
  const RoomPlate outside = painted(0, 5, false, {1, 2, 3});
  EXPECT_EQ(look({outside}, RoomBlend::Mean, {0, 1, 2}, {0, 0, -1}).cameras, 0);
  EXPECT_EQ(look({outside}, RoomBlend::Mean).cameras, 1);
}

TEST(Room, NothingFromAMargin) {
  RoomPlate plate = kThree[2];
  const glm::dvec3 left(-1.2, 1, -2), right(1.2, 1, -2);
  EXPECT_EQ(look({plate}, RoomBlend::Mean, left).cameras, 1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide / 2; ++x) plate.picture.at(x, y)[3] = 0;
  EXPECT_EQ(look({plate}, RoomBlend::Mean, left).cameras, 0);
  EXPECT_EQ(look({plate}, RoomBlend::Mean, right).cameras, 1);
  EXPECT_EQ(look({kThree[2]}, RoomBlend::Mean, {1.99, 2.99, 1.4}, {-1, 0, 0}).cameras, 0) << "out of the picture";
}

// Samples along a wall on which the picture ends, from its middle outwards.
TEST(Room, FeatherFallsToNothingAtTheBorder) {
  const std::vector<RoomPlate> plate{painted(0, 0.5, false, {80, 80, 80})};
  float before = 2;
  int falling = 0;
  for (double x = 0; x < 3; x += 0.01) {
    const RoomLookup::Seen seen = look(plate, RoomBlend::Feathered, {x, 1, -2});
    EXPECT_LE(seen.weight, before) << x;
    if (seen.cameras && seen.weight < before && before <= 1) ++falling;
    if (!seen.cameras) break;
    EXPECT_EQ(look(plate, RoomBlend::Mean, {x, 1, -2}).weight, 1);
    before = seen.weight;
  }
  EXPECT_EQ(look(plate, RoomBlend::Feathered).weight, 1);
  EXPECT_LT(before, 0.03f) << "the weight ends in a step";
  EXPECT_GT(falling, 50);
}

TEST(Room, FeatheredColoursAreWeighted) {
  const std::vector<RoomPlate> plates{painted(0, 0.5, false, {0, 0, 0}), painted(0, 1.9, false, {200, 200, 200})};
  const glm::dvec3 point(2.3, 1, -2);
  const float w0 = look({plates[0]}, RoomBlend::Feathered, point).weight;
  const float w1 = look({plates[1]}, RoomBlend::Feathered, point).weight;
  ASSERT_GT(w0, 0);
  ASSERT_GT(w1, w0 + 0.1f);
  const float want = 200 * w1 / (w0 + w1);
  expectColour(look(plates, RoomBlend::Feathered, point).colour, {want, want, want});
}

TEST(Room, FacesAreSeenFromInside) {
  // Counter-clockwise from inside: the normal points inwards.
  for (int f = 0; f < 6; ++f) {
    const glm::vec3 top_left = package::roomPoint(kBox, f, 0, 0), bottom_left = package::roomPoint(kBox, f, 0, 1),
                    top_right = package::roomPoint(kBox, f, 1, 0);
    const glm::vec3 normal = glm::normalize(glm::cross(bottom_left - top_left, top_right - top_left));
    glm::vec3 inward(0);
    inward[f / 2] = f % 2 ? -1 : 1;
    EXPECT_GT(glm::dot(normal, inward), 0.999f) << "face " << f;
    EXPECT_EQ(top_left[f / 2], f % 2 ? kBox.max[f / 2] : kBox.min[f / 2]);
    EXPECT_EQ(f / 2 == 1 ? top_left.z : -top_left.y, f / 2 == 1 ? kBox.min.z : -kBox.max.y) << "face " << f;
  }
}

TEST(Room, FacesLieApartInThePicture) {
  for (const double density : {3.0, 40.0, 5000.0}) {
    const package::Room room = layOutRoom(kBox, density);
    EXPECT_LE(std::max(room.width, room.height), package::kMaxPictureSide);
    for (size_t a = 0; a < 6; ++a) {
      const package::Rect& r = room.faces[a];
      EXPECT_GE(std::min(r.x, r.y), 8);
      EXPECT_LE(r.x + r.width + 8, room.width);
      EXPECT_LE(r.y + r.height + 8, room.height);
      for (size_t b = 0; b < a; ++b) {
        const package::Rect& o = room.faces[b];
        EXPECT_TRUE(r.x >= o.x + o.width + 16 || o.x >= r.x + r.width + 16 || r.y >= o.y + o.height + 16 ||
                    o.y >= r.y + r.height + 16)
            << a << " and " << b;
      }
    }
  }
}

TEST(Room, WhatNobodySeesContinuesItsNeighbourhood) {
  const std::vector<RoomPlate> plates{painted(0, 1.5, false, {200, 40, 40}), painted(0, -1.5, true, {40, 40, 200})};
  const RoomPicture made = makeRoomPicture(kBox, plates, {RoomBlend::Feathered, 0.1, 30});
  for (const package::Rect& r : made.room.faces)
    for (int y = r.y - 8; y < r.y + r.height + 8; ++y)
      for (int x = r.x - 8; x < r.x + r.width + 8; ++x) {
        const uint8_t* p = made.picture.at(x, y);
        ASSERT_NEAR(p[1], 40, 1) << x << " " << y;
        ASSERT_NEAR(p[0] + p[2], 240, 2) << x << " " << y;
      }
  const auto middle = [&](size_t face, float v) {
    const package::Rect& r = made.room.faces[face];
    return made.picture.at(r.x + r.width / 2, r.y + int(v * float(r.height)));
  };
  EXPECT_GT(middle(4, 0.5f)[0], 195);                        // the wall at -z
  EXPECT_GT(middle(5, 0.5f)[2], 195);                        // at +z
  EXPECT_GT(middle(3, 0.05f)[0], middle(3, 0.95f)[0] + 80);  // the ceiling blends from one to the other
}

}  // namespace
}  // namespace fourdvt::bake
