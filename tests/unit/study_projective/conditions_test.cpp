// SPDX-License-Identifier: Apache-2.0
// Conditions of the study of methods: errors of the requested size, displaced surfaces, test frames.
#include "lab/study/projective/conditions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lab/study/projective/pass_clock.h"
#include "lab/study/projective/proxies.h"

namespace fourdvt::study {
namespace {

std::vector<PinholeCamera> ring(int count) {
  std::vector<PinholeCamera> out;
  for (int i = 0; i < count; ++i) {
    OrbitView view;
    view.azimuth_deg = 360.0 * i / count;
    out.push_back(cameraFromOrbit(view, 320, 240));
  }
  return out;
}

double angle_deg(const PinholeCamera& a, const PinholeCamera& b) {
  const glm::dmat3 turn = glm::dmat3(a.cam_from_world) * glm::transpose(glm::dmat3(b.cam_from_world));
  return std::acos(std::min(1.0, (turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2)) * 180 / M_PI;
}

const Condition& on(const std::vector<Condition>& all, const std::string& axis, const std::string& at) {
  for (const Condition& condition : all)
    if (condition.axis == axis && condition.at == at) return condition;
  ADD_FAILURE() << axis << " " << at;
  return all.front();
}

TEST(Conditions, CalibrationIsOffByWhatTheAxisSaysAndByNothingElse) {
  const auto cameras = ring(64);
  const auto all = calibrationConditions(false);
  const auto turned = miscalibrated(cameras, on(all, "rotation", "0.1"));
  const auto moved = miscalibrated(cameras, on(all, "translation", "5"));
  double squares_deg = 0, squares_mm = 0;
  for (size_t c = 0; c < cameras.size(); ++c) {
    squares_deg += std::pow(angle_deg(turned[c], cameras[c]), 2);
    squares_mm += std::pow(1e3 * glm::distance(moved[c].centreInWorld(), cameras[c].centreInWorld()), 2);
    EXPECT_NEAR(glm::distance(turned[c].centreInWorld(), cameras[c].centreInWorld()), 0, 1e-9);
    EXPECT_NEAR(angle_deg(moved[c], cameras[c]), 0, 1e-4);
    EXPECT_EQ(turned[c].fx, cameras[c].fx);
  }
  // Three normal components each.
  EXPECT_NEAR(std::sqrt(squares_deg / 64), 0.1 * std::sqrt(3.0), 0.02);
  EXPECT_NEAR(std::sqrt(squares_mm / 64), 5 * std::sqrt(3.0), 1);
  const auto again = miscalibrated(cameras, on(calibrationConditions(false), "rotation", "0.1"));
  EXPECT_EQ(again[7].cam_from_world, turned[7].cam_from_world);
  EXPECT_EQ(miscalibrated(cameras, on(all, "gain", "6"))[3].cam_from_world, cameras[3].cam_from_world);
}

TEST(Conditions, GainsDifferByCameraAndChannelAndLeaveTheMatte) {
  const auto all = calibrationConditions(false);
  const std::vector<Image> grey(32, Image(2, 2, 4, 100));
  const auto dyed = withGains(grey, on(all, "gain", "6"));
  double sum = 0, squares = 0;
  for (const Image& picture : dyed) {
    EXPECT_EQ(picture.pixels[3], 100);
    EXPECT_EQ(picture.pixels[0], picture.pixels[12]);
    for (size_t c = 0; c < 3; ++c) sum += picture.pixels[c], squares += std::pow(picture.pixels[c] - 100.0, 2);
  }
  EXPECT_NEAR(sum / 96, 100, 2);
  EXPECT_NEAR(std::sqrt(squares / 96), 6, 1.5);
  EXPECT_EQ(withGains(grey, on(all, "rotation", "0.1"))[0].pixels, grey[0].pixels);
}

TEST(Conditions, NamesAreUniqueAndSaySettings) {
  std::vector<std::string> names;
  for (const auto& list : {proxyConditions(false), cameraConditions(false), calibrationConditions(false)})
    for (const Condition& condition : list) names.push_back(condition.name());
  const size_t count = names.size();
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  EXPECT_EQ(names.size(), count);
  EXPECT_EQ(on(cameraConditions(false), "cameras", "6").setting(), "axis=cameras at=6 proxy=given closest=6");
}

TEST(Proxies, APlaneFacesTheViewAndCoversTheBody) {
  Positions body;
  for (const glm::vec3& p : {glm::vec3(-0.4f, 0, -0.2f), {0.4f, 1.8f, 0.2f}, {0.1f, 0.9f, 0.2f}}) body.push_back(p);
  OrbitView orbit;
  orbit.azimuth_deg = 70, orbit.elevation_deg = 20;
  const PinholeCamera view = cameraFromOrbit(orbit, 320, 240);
  const TriangleMesh plane = facingPlane(body, view);
  const glm::dvec3 towards = glm::normalize(view.centreInWorld() - glm::dvec3(0, 0.9, 0));
  BoundingBox seen{glm::vec3(1e9f), glm::vec3(-1e9f)};
  for (const glm::vec3& p : plane.positions) {
    EXPECT_NEAR(glm::dot(glm::dvec3(p) - glm::dvec3(0, 0.9, 0), towards), 0, 1e-5);
    const glm::vec3 at(view.project(glm::dvec3(p)));
    seen = {glm::min(seen.min, at), glm::max(seen.max, at)};
  }
  for (const glm::vec3& p : body) {
    const glm::dvec3 at = view.project(glm::dvec3(p));
    EXPECT_TRUE(at.x > seen.min.x - 0.01 && at.x < seen.max.x + 0.01);
    EXPECT_TRUE(at.y > seen.min.y - 0.01 && at.y < seen.max.y + 0.01);
  }
  for (const glm::uvec3& f : plane.faces) {
    const glm::dvec3 a(plane.positions[f.x]), b(plane.positions[f.y]), c(plane.positions[f.z]);
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), towards), 0);
  }
}

TEST(Proxies, AStandoffIsAsLargeAsAskedForAndAlongNormals) {
  const TriangleMesh flat = facingPlane({{-1, 0, 0}, {1, 2, 0}}, cameraFromOrbit({}, 320, 240));
  const TriangleMesh off = stoodOff(flat, 15);
  std::vector<float> moved;
  for (size_t v = 0; v < flat.positions.size(); ++v) {
    moved.push_back(off.positions[v].z - flat.positions[v].z);  // along the normal
    EXPECT_NEAR(off.positions[v].x, flat.positions[v].x, 1e-6);
  }
  EXPECT_LE(*std::max_element(moved.begin(), moved.end()), 0.0151);
  EXPECT_GT(*std::max_element(moved.begin(), moved.end()), 0.009);
  EXPECT_LT(*std::min_element(moved.begin(), moved.end()), -0.009);
}

TEST(Frames, TestFramesAreSpread) {
  capture::CaptureSequence sequence;
  sequence.test_frames = {0, 8, 16, 24};
  EXPECT_EQ(spreadTestFrames(sequence, 1), (std::vector<uint32_t>{16}));
  EXPECT_EQ(spreadTestFrames(sequence, 2), (std::vector<uint32_t>{8, 24}));
  EXPECT_EQ(spreadTestFrames(sequence, 9), sequence.test_frames);
}

TEST(PassClock, AddsUpPassesByLabel) {
  const auto device = gpu::createNullDevice();
  PassClock clock(*device);
  ASSERT_TRUE(clock.start().ok());
  auto color = gpu::makeTexture(*device, {.width = 4, .height = 4}).take();
  auto target = gpu::makeTarget(*device, {.colors = {color.id()}}).take();
  device->resetCounters();
  for (const char* label : {"depth maps", "figures", "depth maps"}) {
    device->beginPass({.target = target.id(), .label = label});
    device->endPass();
  }
  const std::vector<uint8_t> pixels(64);
  device->updateTexture(color.id(), {.width = 4, .height = 4}, pixels.data(), 0, 0);
  ASSERT_EQ(clock.parts().size(), 3u);
  EXPECT_EQ(clock.parts()[0].label, "depth maps");
  EXPECT_EQ(clock.parts()[1].label, "figures");
  EXPECT_EQ(clock.parts()[2].label, "upload");
  EXPECT_EQ(device->counters().passes, 6u);  // one to wait for each pass
  EXPECT_EQ(device->counters().texture_updates, 1u);
  EXPECT_EQ(device->takeErrors(), "");
  clock.forget();
  EXPECT_TRUE(clock.parts().empty());
}

}  // namespace
}  // namespace fourdvt::study
