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

TEST_F(FitTest, MatchesDoNotCountAlongStripes) {
  std::vector<View> striped = rest_views;
  for (View& view : striped)
    for (int y = 0; y < view.grey.rows; ++y)
      for (int x = 0; x < view.grey.cols; ++x)
        if (view.matte.at<uint8_t>(y, x) >= 128) view.grey.at<uint8_t>(y, x) = uint8_t(128 + 60 * std::sin(0.7 * x));
  std::vector<glm::vec3> normals;
  computeVertexNormals(scene.faces, scene.rest.data(), scene.rest.size(), normals);
  std::vector<double> along, across;
  for (const PixelMatch& m : matchByFlow(scene.faces, {&striped, &scene.rest}, striped, scene.rest, normals, {})) {
    if (std::abs(scene.rest[m.vertex].y) > 0.2f) continue;
    across.push_back(m.information[0][0]);
    along.push_back(m.information[1][1]);
  }
  ASSERT_GT(across.size(), 100u);
  EXPECT_GT(quantile(across, 0.5), 0.3);
  EXPECT_LT(quantile(along, 0.5), 0.02);
}

TEST_F(FitTest, OutlinesCorrectATemplateThatIsTooThin) {
  const Positions thin = scene.moved([](const glm::dvec3& p) { return p * glm::dvec3(0.96, 1, 0.96); });
  const TriangleMesh surface{thin, scene.faces};
  const NearestSurface nearest(surface);
  const Template thin_model = makeTemplate({uint32_t(thin.size()), {}, scene.faces, {}}, thin, 40, surface);
  const auto radiusWith = [&](double sigma_px) {
    FitOptions options;
    options.surface_sigma_m = 0.05;
    options.outline_sigma_px = sigma_px;
    const Positions found = refined(thin_model, {&surface, &nearest, &rest_views}, options);
    double sum = 0;
    int count = 0;
    for (const glm::vec3& p : found)
      if (std::abs(p.y) < 0.2f) sum += std::hypot(p.x, p.z), ++count;
    return sum / count;
  };
  EXPECT_NEAR(radiusWith(0), 0.096, 2e-4);
  EXPECT_NEAR(radiusWith(0.5), 0.1, 1.8e-3);
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
