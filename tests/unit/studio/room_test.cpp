// SPDX-License-Identifier: Apache-2.0
// The furnished room: a texture that varies from place to place, shadows where the actor blocks the lamp, and plates of
// the same room with different noise.
#include "lab/studio/room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capture/undistort.h"
#include "lab/studio/sensor.h"
#include "lab/studio/shadow.h"
#include "mattes/background_model.h"

namespace fourdvt::studio {
namespace {

struct SmallRoom {
  explicit SmallRoom(uint32_t seed)
      : actor(createProceduralActor({"walk"}, 0.045).take()),
        rig(makeRig({{-0.45f, 0, -0.5f}, {0.45f, 1.8f, 0.5f}}, 4, 120, 160)),
        room(seed, rig, 0, *actor) {
    actor->pose(std::vector<double>{1}, 0.1, pose);
  }
  std::unique_ptr<Actor> actor;
  Rig rig;
  Room room;
  Positions pose;
};

SmallRoom& shared() {
  static SmallRoom made(3);
  return made;
}

TEST(StudioRoom, IsTexturedEverywhereAndOfTheSeed) {
  const Room& room = shared().room;
  const Image& view = room.empty(0);
  int flat = 0, tiles = 0;
  for (int y = 0; y + 16 <= view.height; y += 16)
    for (int x = 0; x + 16 <= view.width; x += 16, ++tiles) {
      double sum = 0, square = 0;
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i) {
          const double v = view.at(x + i, y + j)[1];
          sum += v / 256;
          square += v * v / 256;
        }
      flat += square - sum * sum < 2 * 2;
    }
  EXPECT_EQ(flat, 0) << "of " << tiles;
  EXPECT_EQ(view.pixels, SmallRoom(3).room.empty(0).pixels);
  EXPECT_NE(view.pixels, SmallRoom(4).room.empty(0).pixels);
  EXPECT_NE(view.pixels, room.empty(1).pixels);
}

// A vertex projected along the light onto the floor lies in the shadow; points that no such ray reaches do not.
TEST(StudioRoom, ShadowLiesWhereTheActorStandsInTheLight) {
  SmallRoom& s = shared();
  s.room.setShadow(s.pose);
  const glm::dvec3 light = s.room.light();
  ASSERT_NEAR(glm::length(light), 1, 1e-9);
  glm::dvec2 low(1e9), high(-1e9);
  std::vector<glm::dvec3> thrown;
  for (const glm::vec3& p : s.pose) {
    thrown.push_back(glm::dvec3(p) - light * (double(p.y) / light.y));
    low = glm::min(low, glm::dvec2(thrown.back().x, thrown.back().z));
    high = glm::max(high, glm::dvec2(thrown.back().x, thrown.back().z));
  }
  for (size_t c = 0; c < s.rig.ring.size(); ++c) {
    const PinholeCamera& camera = s.rig.ring[c];
    const Image share = s.room.shadow(c);
    int inside = 0, dark = 0, outside = 0;
    for (const glm::dvec3& p : thrown) {
      const glm::dvec3 pixel = camera.project(p);
      if (pixel.x < 0 || pixel.y < 0 || pixel.x >= camera.width || pixel.y >= camera.height) continue;
      ++inside;
      dark += *share.at(int(pixel.x), int(pixel.y)) > 0;
    }
    EXPECT_GT(inside, 100);
    EXPECT_GT(dark, 0.99 * inside);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        if (*share.at(x, y) == 0) continue;
        const glm::dvec3 ray = glm::transpose(glm::dmat3(camera.cam_from_world)) *
                               glm::dvec3((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
        const glm::dvec3 eye = camera.centreInWorld(), floor = eye - ray * (eye.y / ray.y);
        if (ray.y >= 0 || glm::any(glm::greaterThan(glm::abs(glm::dvec2(floor.x, floor.z)), glm::dvec2(4)))) continue;
        outside +=
            floor.x < low.x - 0.05 || floor.x > high.x + 0.05 || floor.z < low.y - 0.05 || floor.z > high.y + 0.05;
      }
    EXPECT_EQ(outside, 0) << camera.name;
  }
}

double linear(double level) {
  const double v = level / 255;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

TEST(StudioRoom, ShadowScalesLinearLightAndLeavesTheRestAlone) {
  SmallRoom& s = shared();
  s.room.setShadow(s.pose);
  for (size_t c = 0; c < s.rig.ring.size(); ++c) {
    const Image share = s.room.shadow(c), dark = s.room.withShadow(c), &lit = s.room.empty(c);
    double sum_dark = 0, sum_lit = 0;
    for (size_t i = 0; i < lit.pixels.size(); ++i) {
      if (share.pixels[i / 3] == 0) {
        ASSERT_EQ(dark.pixels[i], lit.pixels[i]);
      }
      if (share.pixels[i / 3] < 255) continue;
      sum_dark += linear(dark.pixels[i]);
      sum_lit += linear(lit.pixels[i]);
    }
    ASSERT_GT(sum_lit, 1);
    EXPECT_NEAR(sum_dark / sum_lit, Room::kShadowLight, 0.01);
  }
}

// The plate determines its key: a capture of the green studio is still keyed by colour.
TEST(StudioRoom, IsNoBackdropAndTheGreenStudioIsOne) {
  StudioKnobs knobs;
  knobs.gain_percent = 5;
  for (int camera = 0; camera < 4; ++camera) {
    EXPECT_TRUE(mattes::isChromaPlate(Sensor(knobs, camera, 96, 128).plate())) << camera;
    EXPECT_FALSE(mattes::isChromaPlate(shared().room.empty(size_t(camera)))) << camera;
  }
}

TEST(StudioRoom, PlatesShowTheRoomWithNoiseOfTheirOwn) {
  const Room& room = shared().room;
  StudioKnobs knobs;
  const Sensor plain(knobs, 1, room.empty(1));
  EXPECT_EQ(plain.recordedPlate(0).pixels, room.empty(1).pixels);
  const Image nobody(room.empty(1).width, room.empty(1).height, 4);
  EXPECT_EQ(plain.expose(nobody, 7).pixels, room.empty(1).pixels);
  knobs.noise_levels = 5.1;
  const Sensor noisy(knobs, 1, room.empty(1));
  const Image first = noisy.recordedPlate(0), second = noisy.recordedPlate(1), shot = noisy.expose(nobody, 0);
  EXPECT_NE(first.pixels, second.pixels);
  EXPECT_NE(first.pixels, shot.pixels);
  double square = 0;
  int count = 0;
  for (size_t i = 0; i < first.pixels.size(); ++i) {
    const int v = room.empty(1).pixels[i];
    if (v < 20 || v > 235) continue;
    square += std::pow(first.pixels[i] - v, 2);
    ++count;
  }
  EXPECT_NEAR(std::sqrt(square / count), 5.1, 0.1);
}

// Shadow of a square of side 1 m under an oblique lamp, along the floor through its middle. A disc-shaped lamp of
// radius r, measured across the light, is hidden by 1 - (acos(u) - u sqrt(1 - u²)) / pi where the disc's centre lies u
// r inside a straight edge.
TEST(StudioShadow, EdgeIsAsWideAsTheDisc) {
  const glm::dvec3 light = glm::normalize(glm::dvec3(0.6, -0.8, 0));
  const Positions square{{-0.5f, 2, -0.5f}, {0.5f, 2, -0.5f}, {0.5f, 2, 0.5f}, {-0.5f, 2, 0.5f}};
  const std::vector<glm::uvec3> faces{{0, 1, 2}, {0, 2, 3}};
  for (const double radius : {0.0, 0.05, 0.15}) {
    Shadow shadow(light, faces, radius);
    EXPECT_EQ(shadow.shareAt({1.5, 0, 0}), 0);
    shadow.setPose(square);
    EXPECT_EQ(shadow.shareAt({0, 3, 0}), 0);  // in front of it
    // The square's edge at z = 0.5 is parallel to the light: its shadow on the floor has its edge there, too.
    for (double z = 0.2; z < 0.8; z += 0.01) {
      const double inside = 0.5 - z, u = radius > 0 ? inside / radius : (inside > 0 ? 1 : -1) * 9;
      const double expected =
          std::abs(u) >= 1 ? (u > 0 ? 1 : 0) : 1 - (std::acos(u) - u * std::sqrt(1 - u * u)) / 3.14159265358979;
      if (radius == 0 && std::abs(inside) < 0.004) continue;
      EXPECT_NEAR(shadow.shareAt({1.5, 0, z}), expected, 0.04) << z;
    }
  }
}

double bilinear(const Image& picture, double x, double y, int channel) {
  const int i = int(std::floor(x)), j = int(std::floor(y));
  const double s = x - i, t = y - j;
  const auto at = [&](int u, int v) { return double(picture.at(u, v)[channel]); };
  return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) + t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
}

// Translation, to an eighth of a pixel, at which the second picture's middle matches the first's best.
glm::dvec2 measuredMove(const Image& from, const Image& to) {
  glm::dvec2 best(0);
  double least = 1e18;
  for (int dy = -40; dy <= 40; ++dy)
    for (int dx = -40; dx <= 40; ++dx) {
      double sum = 0;
      for (int y = from.height / 2 - 20; y < from.height / 2 + 20; ++y)
        for (int x = from.width / 2 - 20; x < from.width / 2 + 20; ++x)
          sum += std::pow(bilinear(to, x + dx / 8.0, y + dy / 8.0, 1) - from.at(x, y)[1], 2);
      if (sum < least) least = sum, best = {dx / 8.0, dy / 8.0};
    }
  return best;
}

TEST(StudioRoom, PlatesOfMovedCamerasAreOffByTheKnob) {
  SmallRoom& s = shared();
  StudioKnobs knobs;
  knobs.plate_move_pixels = 3;
  const auto cameras = plateCameras(s.rig.ring, knobs);
  std::vector<glm::dvec2> moves;
  for (size_t c = 0; c < cameras.size(); ++c) {
    moves.push_back(measuredMove(s.room.empty(c), s.room.emptySeenBy(cameras[c])));
    EXPECT_NEAR(glm::length(moves.back()), 3, 0.3) << c;
    EXPECT_NEAR(glm::distance(cameras[c].centreInWorld(), s.rig.ring[c].centreInWorld()), 6e-4, 1e-4);
  }
  EXPECT_GT(glm::distance(moves[0], moves[1]), 0.5);
  knobs.plate_move_pixels = 0;
  EXPECT_EQ(s.room.emptySeenBy(plateCameras(s.rig.ring, knobs)[1]).pixels, s.room.empty(1).pixels);
}

// A filmed pixel shows the pinhole picture's content at pinholePixel.
TEST(StudioRoom, IsFilmedThroughTheLens) {
  SmallRoom& s = shared();
  const PinholeCamera& camera = s.rig.ring[0];
  const std::array<double, 3> k{-0.4, 0.2, 1};
  const Room bent(3, s.rig, 0, *s.actor, 0, 0, Lens::create(k, camera).take());
  const capture::CaptureCamera lens{camera, {.k1 = k[0], .k2 = k[1], .k3 = k[2]}};
  double with = 0, without = 0;
  for (int y = 4; y < camera.height - 4; ++y)
    for (int x = 4; x < camera.width - 4; ++x) {
      const glm::dvec2 filmed = capture::filmedPixel(lens, {x + 0.5, y + 0.5}) - 0.5;
      const double expected = s.room.empty(0).at(x, y)[1];
      with += std::abs(bilinear(bent.empty(0), filmed.x, filmed.y, 1) - expected);
      without += std::abs(bent.empty(0).at(x, y)[1] - expected);
    }
  EXPECT_LT(with, 0.5 * without);
}

}  // namespace
}  // namespace fourdvt::studio
