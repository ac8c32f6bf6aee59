// SPDX-License-Identifier: Apache-2.0
// Fits of a template to a frame on a textured tube, whose motion is known.
#include "track/fit.h"

#include <gtest/gtest.h>

#include "base/robust.h"
#include "tube_scene.h"

namespace fourdvt::track {
namespace {

struct FitTest : ::testing::Test {
  TubeScene scene;
  Template model =
      makeTemplate({uint32_t(scene.rest.size()), {}, scene.faces, {}}, scene.rest, 40, {scene.rest, scene.faces});
  std::vector<View> rest_views = scene.views(scene.rest);

  // Distances of the fit from the truth, metres, of vertices that a camera sees; the target is the posed tube itself.
  std::vector<double> errorsAt(const Positions& truth, const FitOptions& options) const {
    const TriangleMesh surface{truth, scene.faces};
    const NearestSurface nearest(surface);
    const std::vector<View> views = scene.views(truth);
    const PosedViews rest{&rest_views, &scene.rest};
    const FittedFrame found = fitFrame(model, restFrame(model), rest, rest, {&surface, &nearest, &views}, options);
    std::vector<glm::vec3> normals;
    computeVertexNormals(scene.faces, truth.data(), truth.size(), normals);
    const std::vector<float> seen = visibilityOf(views, scene.faces, truth, normals);
    std::vector<double> errors;
    for (size_t v = 0; v < truth.size(); ++v)
      if (seen[v] > 0.3f) errors.push_back(glm::distance(truth[v], found.positions[v]));
    return errors;
  }
};

TEST_F(FitTest, FlowFindsATurnThatTheSurfaceDoesNotShow) {
  const Positions turned = scene.moved([](const glm::dvec3& p) { return turnedAboutY(p, 0.15); });
  EXPECT_LT(quantile(errorsAt(turned, {}), 0.95), 0.003);
  FitOptions surface_alone;
  surface_alone.flow_from_parent = surface_alone.flow_from_anchor = false;
  EXPECT_GT(quantile(errorsAt(turned, surface_alone), 0.5), 0.01);
}

TEST_F(FitTest, BendAndShiftAreFollowed) {
  const double radius = 2;  // of the arc that the axis becomes
  const Positions bent = scene.moved([&](const glm::dvec3& p) {
    const double angle = p.y / radius;
    return glm::dvec3(radius - (radius - p.x) * std::cos(angle) + 0.02, (radius - p.x) * std::sin(angle), p.z + 0.015);
  });
  EXPECT_LT(quantile(errorsAt(bent, {}), 0.95), 0.005);
}

TEST_F(FitTest, FlowMatchesAreWithinHalfAPixel) {
  const Positions turned =
      scene.moved([](const glm::dvec3& p) { return turnedAboutY(p, 0.1) + glm::dvec3(0.01, 0, 0); });
  const std::vector<View> views = scene.views(turned);
  std::vector<glm::vec3> normals;
  computeVertexNormals(scene.faces, scene.rest.data(), scene.rest.size(), normals);
  const auto matches = matchByFlow(scene.faces, {&rest_views, &scene.rest}, views, scene.rest, normals, {});
  EXPECT_GT(matches.size(), scene.rest.size());
  std::vector<double> errors;
  for (const PixelMatch& m : matches)
    errors.push_back(glm::distance(m.pixel, glm::dvec2(views[m.camera].camera.project(turned[m.vertex]))));
  EXPECT_LT(quantile(errors, 0.5), 0.3);
  EXPECT_LT(quantile(errors, 0.9), 1);
}

TEST_F(FitTest, VisibilityIsThatOfTheRing) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(scene.faces, scene.rest.data(), scene.rest.size(), normals);
  const std::vector<float> seen = visibilityOf(rest_views, scene.faces, scene.rest, normals);
  size_t count = 0;
  for (size_t v = 0; v < seen.size(); ++v) count += seen[v] > 0.6f;
  EXPECT_GT(count, seen.size() * 8 / 10);
  EXPECT_EQ(seen[scene.rest.size() - 2], 0);  // the lower end: all cameras stand above it
}

}  // namespace
}  // namespace fourdvt::track
