// SPDX-License-Identifier: Apache-2.0
// The studio's geometry: walks on surfaces, the procedural body and its gait, drift and its exact correspondence,
// cameras, sensor. Drawing: tests/render/studio_test.cpp.
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "capture_fixture.h"
#include "lab/studio/actors/actor.h"
#include "lab/studio/actors/body.h"
#include "lab/studio/rig.h"
#include "lab/studio/sensor.h"
#include "lab/studio/set.h"
#include "lab/studio/tracker.h"

namespace fourdvt::studio {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Built once: meshing and painting take a second.
Actor& walkJogRun() {
  static const auto actor = createProceduralActor({"walk", "jog", "run"}, 0.025).take();
  return *actor;
}

// Prism over a regular n-gon of radius 1, open at the ends, z from 0 to 2.
Surface prism(int n) {
  std::vector<glm::uvec3> faces;
  Positions positions;
  for (int k = 0; k < n; ++k)
    for (const float z : {0.0f, 2.0f}) positions.emplace_back(std::cos(2 * kPi * k / n), std::sin(2 * kPi * k / n), z);
  for (uint32_t k = 0; k < uint32_t(n); ++k) {
    const uint32_t a = 2 * k, b = 2 * ((k + 1) % n);
    faces.push_back({a, b, b + 1});
    faces.push_back({a, b + 1, a + 1});
  }
  return {faces, positions};
}

TEST(StudioSurface, WalkGoesRoundAPrismAndComesBack) {
  const int n = 12;
  const Surface surface = prism(n);
  const double round = n * 2 * std::sin(kPi / n);
  SurfacePoint start = surface.nearest({1, 0, 1});
  const glm::dvec3 from = surface.place(start, surface.positions());
  EXPECT_NEAR(glm::distance(from, glm::dvec3(1, 0, 1)), 0, 1e-6);
  const glm::dvec3 once = surface.place(surface.walk(start, {0, round, 0}), surface.positions());
  EXPECT_NEAR(glm::distance(once, from), 0, 1e-6);
  // A helix of half a turn, which climbs in proportion to its slope.
  const double up = 0.6, half = 0.5 * round;
  const glm::dvec3 start_side = surface.positions()[2];
  const glm::dvec3 across = glm::normalize(start_side - glm::dvec3(1, 0, 0)) * half;
  const glm::dvec3 far = surface.place(surface.walk(start, across + glm::dvec3(0, 0, up)), surface.positions());
  EXPECT_NEAR(glm::distance(far, glm::dvec3(-1, 0, 1 + up)), 0, 1e-5);
}

TEST(StudioSurface, WalkStopsAtAnOpenEdge) {
  const Surface surface = prism(12);
  const SurfacePoint start = surface.nearest({1, 0, 1});
  EXPECT_NEAR(surface.place(surface.walk(start, {0, 0, 5}), surface.positions()).z, 2, 1e-6);
}

TEST(StudioBody, IsClosedConnectedAndOutwards) {
  const RestMesh& mesh = walkJogRun().tracked();
  EXPECT_GT(mesh.topology.vertex_count, 3500u);
  EXPECT_LT(mesh.topology.vertex_count, 4500u);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;  // directed
  double volume = 0;
  for (const glm::uvec3& f : mesh.topology.face_vertices) {
    for (int k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
    volume += glm::dot(glm::dvec3(mesh.positions[f.x]),
                       glm::cross(glm::dvec3(mesh.positions[f.y]), glm::dvec3(mesh.positions[f.z]))) /
              6;
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_GT(volume, 0.05);  // m³, for a slim person
  EXPECT_LT(volume, 0.12);
  // Genus 0 and one component.
  EXPECT_EQ(int(mesh.positions.size()) - int(edges.size() / 2) + int(mesh.topology.faceCount()), 2);
}

TEST(StudioBody, VerticesLieOnTheBody) {
  for (const RestMesh* mesh : {&walkJogRun().tracked(), &walkJogRun().surface()})
    for (const glm::vec3& p : mesh->positions) ASSERT_NEAR(bodyDistance(p), 0, 1e-4);
}

TEST(StudioBody, AtlasDoesNotOverlap) {
  const MeshTopology& t = walkJogRun().tracked().topology;
  constexpr int kSide = 1024;
  std::vector<uint8_t> hits(kSide * kSide, 0);
  int covered = 0, twice = 0;
  for (const glm::uvec3& f : t.face_uvs) {
    glm::dvec2 p[3];
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(glm::all(glm::greaterThanEqual(t.uvs[f[k]], glm::vec2(0))));
      ASSERT_TRUE(glm::all(glm::lessThanEqual(t.uvs[f[k]], glm::vec2(1))));
      p[k] = glm::dvec2(t.uvs[f[k]]) * double(kSide);
    }
    const auto side = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    const glm::dvec2 low = glm::min(p[0], glm::min(p[1], p[2])), high = glm::max(p[0], glm::max(p[1], p[2]));
    const double winding = side(p[0], p[1], p[2]) < 0 ? -1 : 1;
    for (int y = int(low.y); y <= int(high.y); ++y)
      for (int x = int(low.x); x <= int(high.x); ++x) {
        const glm::dvec2 q(x + 0.5, y + 0.5);
        bool inside = true;
        for (int k = 0; k < 3; ++k) inside &= winding * side(p[k], p[(k + 1) % 3], q) > 1e-9;
        if (!inside) continue;
        ++covered;
        twice += hits[y * kSide + x]++ > 0;
      }
  }
  EXPECT_GT(covered, 0.35 * kSide * kSide);
  EXPECT_LT(twice, 1e-3 * covered);
}

// Colours of the texture at the first corners of the faces whose rest position satisfies `chosen`.
std::set<std::array<uint8_t, 3>> coloursOf(const RestMesh& mesh, const Image& texture,
                                           const std::function<bool(const glm::vec3&)>& chosen) {
  std::set<std::array<uint8_t, 3>> out;
  for (uint32_t f = 0; f < mesh.topology.faceCount(); ++f) {
    if (!chosen(mesh.positions[mesh.topology.face_vertices[f].x])) continue;
    glm::vec2 uv(0);
    for (int k = 0; k < 3; ++k) uv += mesh.topology.uvs[mesh.topology.face_uvs[f][k]] / 3.0f;
    const uint8_t* p = texture.at(int(uv.x * texture.width), int(uv.y * texture.height));
    out.insert({p[0], p[1], p[2]});
  }
  return out;
}

TEST(StudioBody, PlainClothesHaveOneColourEachAndSkinHasMany) {
  const RestMesh& mesh = walkJogRun().surface();
  const Image texture = paintBody(mesh, 1024, true);
  EXPECT_EQ(coloursOf(mesh, texture, [](const glm::vec3& p) { return p.y > 1.15f && p.y < 1.35f; }).size(), 1u);
  EXPECT_EQ(coloursOf(mesh, texture, [](const glm::vec3& p) { return p.y > 0.2f && p.y < 0.8f; }).size(), 1u);
  EXPECT_GT(coloursOf(mesh, texture, [](const glm::vec3& p) { return p.y > 1.55f; }).size(), 100u);
}

TEST(StudioGait, IsALoopAndItsParameterIsExact) {
  Positions a, b;
  walkJogRun().pose(std::vector<double>{0.7, 0, 0.3}, 0, a);
  walkJogRun().pose(std::vector<double>{0.7, 0, 0.3}, 1, b);
  for (size_t v = 0; v < a.size(); ++v) ASSERT_NEAR(glm::distance(a[v], b[v]), 0, 1e-6);
  walkJogRun().pose(std::vector<double>{0.5, 0, 0.5}, 0.3, a);
  walkJogRun().pose(std::vector<double>{0, 1, 0}, 0.3, b);
  for (size_t v = 0; v < a.size(); ++v) ASSERT_NEAR(glm::distance(a[v], b[v]), 0, 1e-6);
}

// A vertex under the left toes, which follows their bone only.
uint32_t leftSole(const Actor& actor) {
  const Positions& rest = actor.surface().positions;
  uint32_t sole = 0;
  for (uint32_t v = 0; v < rest.size(); ++v)
    if (rest[v].x > 0 && rest[v].z > 0.08f && rest[v].y < rest[sole].y) sole = v;
  return sole;
}

// A sole on the ground moves back exactly at the root's speed, so that it does not slide in the world.
TEST(StudioGait, FeetDoNotSlide) {
  Actor& actor = walkJogRun();
  const uint32_t sole = leftSole(actor);
  for (const double w : {0.0, 0.4, 0.8, 1.0}) {
    const std::vector<double> shares{1 - w, 0, w};
    double duration = 0, speed = 0;
    for (const size_t m : {0u, 2u}) {
      duration += shares[m] * actor.motions()[m].duration_s;
      speed += shares[m] * actor.motions()[m].root_velocity_mps.z;
    }
    Positions first, later;
    actor.pose(shares, 0.1, first);
    for (const double phase : {0.2, 0.3, 0.4}) {
      actor.pose(shares, phase, later);
      const glm::dvec3 moved(later[sole] - first[sole]);
      EXPECT_NEAR(moved.z, -speed * duration * (phase - 0.1), 1.5e-3) << w << " " << phase;
      EXPECT_NEAR(moved.y, 0, 1.5e-3) << w << " " << phase;
    }
  }
}

// Strides continue through a clip's frames, and lead through the middle of the stage.
TEST(StudioGait, StridesTravelByTheirSpeed) {
  const auto striding = [](bool travel) {
    return withStrides(createProceduralActor({"walk", "stand"}, 0.045).take(), 2.5, travel);
  };
  const auto one = createProceduralActor({"walk", "stand"}, 0.045).take(), here = striding(false),
             there = striding(true);
  const Motion &stride = one->motions()[0], &walk = there->motions()[0];
  EXPECT_FALSE(walk.loop);
  EXPECT_EQ(walk.duration_s, 2.5 * stride.duration_s);
  EXPECT_EQ(walk.root_velocity_mps, glm::dvec3(0));
  EXPECT_EQ(here->motions()[0].root_velocity_mps, stride.root_velocity_mps);
  EXPECT_TRUE(there->motions()[1].loop);
  const std::vector<double> shares{1, 0};
  for (const double strides : {0.0, 0.7, 1.25, 2.5}) {
    const double phase = strides / 2.5;
    Positions wanted, standing, going;
    one->pose(shares, strides - std::floor(strides), wanted);
    here->pose(shares, phase, standing);
    there->pose(shares, phase, going);
    const glm::dvec3 way = (strides - 1.25) * stride.duration_s * stride.root_velocity_mps;
    for (size_t v = 0; v < wanted.size(); v += 97) {
      EXPECT_LT(glm::distance(standing[v], wanted[v]), 1e-5);
      EXPECT_LT(glm::distance(glm::dvec3(going[v]), glm::dvec3(wanted[v]) + way), 1e-5);
    }
  }
}

// Mid-stance is at the same phase for every parameter: the foot is then below the body.
TEST(StudioGait, OnePhaseIsOnePoseOfTheStride) {
  Actor& actor = walkJogRun();
  const Positions& rest = actor.surface().positions;
  uint32_t left = 0, right = 0;  // toes
  for (uint32_t v = 0; v < rest.size(); ++v) {
    if (rest[v].x > 0 && rest[v].z > rest[left].z) left = v;
    if (rest[v].x < 0 && rest[v].z > rest[right].z) right = v;
  }
  Positions pose;
  for (const double w : {0.0, 0.3, 0.7, 1.0}) {
    actor.pose(std::vector<double>{1 - w, 0, w}, 0.25, pose);
    EXPECT_NEAR(pose[left].z, rest[left].z, 0.02) << w;
    actor.pose(std::vector<double>{1 - w, 0, w}, 0.75, pose);
    EXPECT_NEAR(pose[right].z, rest[right].z, 0.02) << w;
  }
}

// Lift-off and touch-down have no corner in the foot's path: twice the samples give a quarter of the bend.
TEST(StudioGait, FeetMoveSmoothlyBetweenTheMembers) {
  Actor& actor = walkJogRun();
  const uint32_t sole = leftSole(actor);
  const auto maxBend = [&](double w, int samples) {
    double most = 0;
    std::array<Positions, 3> p;
    for (int i = 0; i < samples; ++i) {
      for (int k = 0; k < 3; ++k) actor.pose(std::vector<double>{1 - w, 0, w}, double(i + k) / samples, p[size_t(k)]);
      most = std::max(most, double(glm::length(p[0][sole] - 2.0f * p[1][sole] + p[2][sole])));
    }
    return most;
  };
  for (const double w : {0.3, 0.7}) EXPECT_LT(maxBend(w, 120), 0.4 * maxBend(w, 60)) << w;
}

Actor& standAndRaise() {
  static const auto actor = createProceduralActor({"stand", "raise"}, 0.045).take();
  return *actor;
}

float travel(Actor& actor, size_t motion, uint32_t vertex) {
  std::vector<double> shares(actor.motions().size(), 0);
  shares[motion] = 1;
  Positions first, later;
  actor.pose(shares, 0, first);
  float out = 0;
  for (int i = 1; i <= 8; ++i) {
    actor.pose(shares, i / 8.0, later);
    out = std::max(out, glm::distance(first[vertex], later[vertex]));
  }
  return out;
}

TEST(StudioStanding, FeetStayAndTheBodySways) {
  Actor& actor = standAndRaise();
  EXPECT_TRUE(actor.motions()[0].loop);
  EXPECT_FALSE(actor.motions()[1].loop);
  const Positions& rest = actor.surface().positions;
  const uint32_t sole = leftSole(actor);
  uint32_t crown = 0;
  for (uint32_t v = 0; v < rest.size(); ++v)
    if (rest[v].y > rest[crown].y) crown = v;
  for (const size_t motion : {0u, 1u}) EXPECT_LT(travel(actor, motion, sole), 1e-4f) << motion;
  EXPECT_GT(travel(actor, 0, crown), 0.005f);
  EXPECT_LT(travel(actor, 0, crown), 0.03f);
  Positions first, last;
  actor.pose(std::vector<double>{1, 0}, 0, first);
  actor.pose(std::vector<double>{1, 0}, 1, last);
  for (size_t v = 0; v < first.size(); ++v) ASSERT_LT(glm::distance(first[v], last[v]), 1e-6f);
}

TEST(StudioStanding, ArmsRiseFromHangingToAboveTheHead) {
  Actor& actor = standAndRaise();
  const Positions& rest = actor.surface().positions;
  for (const float side : {-1.0f, 1.0f}) {
    uint32_t hand = 0;
    for (uint32_t v = 0; v < rest.size(); ++v)
      if (side * rest[v].x > side * rest[hand].x) hand = v;
    Positions pose;
    float height = 0;
    for (const double phase : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      actor.pose(std::vector<double>{0, 1}, phase, pose);
      EXPECT_GT(pose[hand].y, height) << phase;
      height = pose[hand].y;
      if (phase == 0) EXPECT_LT(height, 0.9f);
    }
    EXPECT_GT(height, 1.8f);
  }
}

TEST(StudioTracker, DriftIsAsFarAsTheKnobSays) {
  StudioKnobs knobs;
  knobs.drift_mm = 12;
  const Tracker tracker(walkJogRun(), knobs);
  const auto first = tracker.points(0, 0), last = tracker.points(1, 0), middle = tracker.points(0.5, 0);
  const Surface& surface = tracker.actorSurface();
  double largest = 0, mean = 0, ratio = 0;
  for (uint32_t v = 0; v < first.size(); ++v) {
    const glm::dvec3 a = surface.place(first[v], surface.positions()), b = surface.place(last[v], surface.positions());
    const double expected = 0.012 * glm::length(tracker.driftDirection(v));
    // The chord is slightly shorter than the path along the skin, never longer.
    ASSERT_LE(glm::distance(a, b), expected * 1.001 + 1e-7);
    ASSERT_GE(glm::distance(a, b), expected * 0.3 - 1e-7);  // across the folds of armpits and neck
    ratio += glm::distance(a, b) / expected / double(first.size());
    const glm::dvec3 here = surface.place(middle[v], surface.positions());
    ASSERT_NEAR(glm::distance(here, glm::dvec3(tracker.trackedSurface().positions()[v])), 0, 1e-5);
    largest = std::max(largest, glm::distance(a, b));
    mean += glm::distance(a, b) / double(first.size());
  }
  EXPECT_NEAR(largest, 0.012, 0.0003);
  EXPECT_GT(mean, 0.006);
  EXPECT_GT(ratio, 0.98);
}

// At the aligned point `run` has the material that `walk` has at the vertex.
TEST(StudioTracker, AlignmentFindsTheSameMaterial) {
  StudioKnobs knobs;
  knobs.drift_mm = 12;
  const Tracker tracker(walkJogRun(), knobs);
  const Positions& rest = tracker.actorSurface().positions();
  const Positions walk = tracker.truth(tracker.points(0, 0.3), rest), run = tracker.truth(tracker.points(1, 0.3), rest);
  const auto aligned = tracker.alignment(0, 1, 0.3);
  const Surface& mesh = tracker.trackedSurface();
  double mean_moved = 0, mean_missed = 0, worst = 0;
  for (uint32_t v = 0; v < aligned.size(); ++v) {
    const double missed = glm::distance(mesh.place(aligned[v], run), glm::dvec3(walk[v]));
    worst = std::max(worst, missed);
    mean_missed += missed / double(aligned.size());
    mean_moved += glm::distance(mesh.place(aligned[v], mesh.positions()), glm::dvec3(mesh.positions()[v])) /
                  double(aligned.size());
  }
  EXPECT_GT(mean_moved, 0.005);
  EXPECT_LT(mean_missed, 0.0006);  // faces of the tracked mesh lie slightly inside the skin
  EXPECT_LT(worst, 0.006);
}

TEST(StudioTracker, NoDriftIsNoAlignment) {
  const Tracker tracker(walkJogRun(), StudioKnobs());
  const auto aligned = tracker.alignment(0, 1, 0.3);
  const Surface& mesh = tracker.trackedSurface();
  for (uint32_t v = 0; v < aligned.size(); ++v)
    ASSERT_NEAR(glm::distance(mesh.place(aligned[v], mesh.positions()), glm::dvec3(mesh.positions()[v])), 0, 1e-5);
}

TEST(StudioTracker, ProxyErrorStandsOffByAtMostTheKnob) {
  StudioKnobs knobs;
  knobs.proxy_mm = 5;
  const Tracker tracker(walkJogRun(), knobs);
  const auto points = tracker.points(0, 0);
  const Positions& rest = tracker.actorSurface().positions();
  const Positions exact = tracker.truth(points, rest), captured = tracker.captured(points, rest);
  float largest = 0;
  for (size_t v = 0; v < exact.size(); ++v) largest = std::max(largest, glm::distance(exact[v], captured[v]));
  EXPECT_LE(largest, 0.00501f);
  EXPECT_GT(largest, 0.004f);
}

TEST(StudioRig, SeesEveryCornerAndCalibrationErrorsAreOfTheirSize) {
  const BoundingBox box{{-0.4f, 0, -0.5f}, {0.4f, 1.8f, 0.5f}};
  const Rig rig = makeRig(box, 8, 480, 640);
  ASSERT_EQ(rig.ring.size(), 8u);
  ASSERT_EQ(rig.test.size(), 3u);
  for (const auto* list : {&rig.ring, &rig.test})
    for (const PinholeCamera& camera : *list)
      for (int k = 0; k < 8; ++k) {
        const glm::dvec3 p = camera.project(
            {k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z});
        EXPECT_TRUE(p.z > rig.near_m && p.z < rig.far_m && p.x > 0 && p.y > 0 && p.x < 480 && p.y < 640);
      }
  StudioKnobs knobs;
  for (size_t c = 0; c < 8; ++c) {
    const glm::dmat4 same = miscalibrated(rig.ring, knobs)[c].cam_from_world - rig.ring[c].cam_from_world;
    for (int k = 0; k < 4; ++k) EXPECT_LT(glm::length(same[k]), 1e-12);
  }
  knobs.translation_mm = 5;
  knobs.rotation_deg = 0.2;
  const auto wrong = miscalibrated(rig.ring, knobs), again = miscalibrated(rig.ring, knobs);
  double moved = 0, turned = 0;
  for (size_t c = 0; c < 8; ++c) {
    EXPECT_EQ(wrong[c].cam_from_world, again[c].cam_from_world);
    moved += std::pow(glm::distance(wrong[c].centreInWorld(), rig.ring[c].centreInWorld()), 2);
    const glm::dmat3 change =
        glm::dmat3(wrong[c].cam_from_world) * glm::transpose(glm::dmat3(rig.ring[c].cam_from_world));
    turned += std::pow(std::acos(std::min(1.0, (change[0][0] + change[1][1] + change[2][2] - 1) / 2)) * 180 / kPi, 2);
  }
  EXPECT_NEAR(std::sqrt(moved / 24), 0.005, 0.002);  // 24 components
  EXPECT_NEAR(std::sqrt(turned / 24), 0.2, 0.08);
}

TEST(StudioTimes, LoopsGoOnAndOtherMotionsHoldTheirEnds) {
  const Motion loop{"a", 1, true, {}}, clip{"b", 1, false, {}};
  EXPECT_NEAR(framePhase(loop, 9.5, 10), 0.95, 1e-12);
  EXPECT_NEAR(framePhase(loop, 10.5, 10), 0.05, 1e-12);
  EXPECT_NEAR(framePhase(loop, -0.5, 10), 0.95, 1e-12);
  EXPECT_NEAR(framePhase(clip, 4.5, 10), 0.5, 1e-12);
  EXPECT_EQ(framePhase(clip, 9.5, 10), 1);
  EXPECT_EQ(framePhase(clip, -0.5, 10), 0);
}

TEST(StudioRig, NamesOfManyCamerasHaveThreeDigits) {
  const Rig rig = makeRig({{-0.4f, 0, -0.5f}, {0.4f, 1.8f, 0.5f}}, 128, 48, 64);
  ASSERT_EQ(rig.ring.size(), 128u);
  EXPECT_EQ(rig.ring[9].name, "cam09");
  EXPECT_EQ(rig.ring[127].name, "cam127");
}

TEST(StudioSensor, NoiseGainAndErosionAreOfTheirSize) {
  Image picture(64, 64, 4, 0);
  for (int y = 16; y < 48; ++y)
    for (int x = 16; x < 48; ++x) std::fill_n(picture.at(x, y), 4, uint8_t(255)), picture.at(x, y)[1] = 100;
  StudioKnobs knobs;
  const Sensor plain(knobs, 0, 64, 64);
  const Image exposed = plain.expose(picture, 0);
  EXPECT_EQ(exposed.at(30, 30)[1], 100);
  EXPECT_TRUE(std::equal(exposed.at(2, 2), exposed.at(2, 2) + 3, plain.plate().at(2, 2)));
  EXPECT_EQ(plain.matte(picture).at(16, 30)[0], 255);
  knobs.noise_levels = 3;
  knobs.erosion_pixels = 2;
  const Sensor noisy(knobs, 0, 64, 64);
  const Image one = noisy.expose(picture, 0), two = noisy.expose(picture, 1);
  double square = 0;
  for (int y = 16; y < 48; ++y)
    for (int x = 16; x < 48; ++x) square += std::pow(one.at(x, y)[1] - 100.0, 2) / 1024;
  EXPECT_NEAR(std::sqrt(square), 3, 0.3);
  EXPECT_NE(one.pixels, two.pixels);
  EXPECT_EQ(one.pixels, noisy.expose(picture, 0).pixels);
  EXPECT_EQ(noisy.matte(picture).at(17, 30)[0], 0);
  EXPECT_EQ(noisy.matte(picture).at(18, 30)[0], 255);
}

// Empty picture of a grey backdrop: its levels are the gain times the plate's.
TEST(StudioSensor, GainDriftsSmoothlyAroundThePlates) {
  StudioKnobs knobs;
  const Image nobody(8, 8, 4, 0);
  const auto measured = [&](int camera, double time) {
    const Sensor sensor(knobs, camera, Image(8, 8, 3, 120));
    const Image picture = sensor.expose(nobody, 0, nullptr, sensor.drift(0, time));
    EXPECT_EQ(sensor.recordedPlate(0).at(3, 3)[0], 120);
    const uint8_t* p = picture.at(3, 3);
    return glm::dvec3(p[0], p[1], p[2]) / 120.0;
  };
  constexpr double kStep = 0.5 / 120;
  const auto extremes = [&](int channel) {
    glm::dvec2 low_high(9, 0);
    for (int camera = 0; camera < 6; ++camera)
      for (int i = 0; i <= 25; ++i) {
        const double gain = measured(camera, i / 25.0)[channel];
        low_high = {std::min(low_high.x, gain), std::max(low_high.y, gain)};
        const double before = measured(camera, std::max(0, i - 1) / 25.0)[channel];
        EXPECT_LE(std::abs(gain - before), 0.1 * 2 * kPi / 25 + 2 * kStep) << camera << " " << i;
      }
    return low_high;
  };
  EXPECT_EQ(measured(2, 0.5), glm::dvec3(1));
  knobs.exposure_drift_percent = 10;
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(extremes(channel).x, 0.9, 0.01);
    EXPECT_NEAR(extremes(channel).y, 1.1, 0.01);
  }
  EXPECT_EQ(measured(2, 0.5).x, measured(2, 0.5).z);
  EXPECT_NE(measured(2, 0.5).x, measured(3, 0.5).x);
  knobs.exposure_drift_percent = 0;
  knobs.white_balance_drift_percent = 10;
  EXPECT_NEAR(extremes(0).y, 1.1, 0.01);
  EXPECT_NEAR(extremes(2).x, 0.9, 0.01);
  for (const double time : {0.0, 0.3, 0.7, 1.0}) {
    EXPECT_EQ(measured(1, time).y, 1);
    EXPECT_NEAR(measured(1, time).x - 1, 1 - measured(1, time).z, 2 * kStep);
  }
}

TEST(StudioOptions, AreChecked) {
  StudioOptions o;
  EXPECT_NE(o.check(), "");  // no folder
  o.folder = "x";
  EXPECT_EQ(o.check(), "");
  o.width = 481;
  EXPECT_NE(o.check(), "");
  o = {};
  o.folder = "x";
  o.classes = {{"c", "p", {"a", "a"}}};
  EXPECT_NE(o.check().find("twice"), std::string::npos);
  o.classes = {{"c", "p", {"a"}}};
  EXPECT_NE(o.check(), "");
  o.classes.clear();
  o.sequences = {"a/b"};
  EXPECT_NE(o.check(), "");
  o.sequences.clear();
  o.scale = 0;
  EXPECT_NE(o.check(), "");
  o.scale = 1;
  o.cameras = 128;
  EXPECT_EQ(o.check(), "");
  o.cameras = 129;
  EXPECT_NE(o.check(), "");
  o.cameras = 8;
  o.frames = 3;
  EXPECT_EQ(o.check(), "");
  o.classes = {{"c", "p", {"a", "b"}}};
  EXPECT_NE(o.check().find("--frames"), std::string::npos);
  o.frames = 0;
  o.strides = 2;
  EXPECT_NE(o.check().find("--strides"), std::string::npos);
  o.classes.clear();
  o.travel = true;
  EXPECT_EQ(o.check(), "");
  o.strides = 0;
  EXPECT_NE(o.check().find("--strides"), std::string::npos);
  o.travel = false;
  o.knobs.plain_clothes = true;
  EXPECT_EQ(o.check(), "");
  o.actor = "model.glb";
  EXPECT_NE(o.check(), "");
  o.actor = "procedural";
  o.knobs.plain_clothes = false;
  o.room_size_m = 9;
  EXPECT_NE(o.check().find("--room"), std::string::npos);
  o.room_size_m = 0;
  o.knobs.plate_move_pixels = 1;
  EXPECT_NE(o.check().find("--room"), std::string::npos);
  o.knobs.plate_move_pixels = 0;
  o.bystander = true;
  EXPECT_NE(o.check().find("--room"), std::string::npos);
  o.bystander = false;
  o.knobs.soft_shadow_m = 0.1;
  EXPECT_NE(o.check().find("--room"), std::string::npos);
  o.knobs.soft_shadow_m = 0;
  o.plates = 0;
  EXPECT_NE(o.check().find("--room"), std::string::npos);
  o.plates = 3;
  EXPECT_NE(o.check().find("--room"), std::string::npos);
  o.room = true;
  EXPECT_EQ(o.check(), "");
  o.knobs.erosion_pixels = 1;
  EXPECT_NE(o.check(), "");
}

}  // namespace
}  // namespace fourdvt::studio
