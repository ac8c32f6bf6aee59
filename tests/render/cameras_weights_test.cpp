// SPDX-License-Identifier: Apache-2.0
// Weights and blur, where known analytically, of the methods that Floating Textures is compared with: lumigraph,
// filtered, band-limited.
#include <cmath>

#include "../unit/lens_shift.h"
#include "camera_figure.h"
#include "render/cameras/camera_blend.h"

namespace fourdvt::testing {
namespace {

constexpr int kViewSide = 65;  // odd: the middle pixel looks straight ahead
constexpr double kDegree = 3.14159265358979 / 180, kDistance_m = 3, kFocal_px = 60;

// Camera at this azimuth that looks at the wall's middle.
PinholeCamera onArc(double azimuth_deg, int side = kSide) {
  const double a = azimuth_deg * kDegree;
  return lookAt({kDistance_m * std::sin(a), 1, kDistance_m * std::cos(a)}, {0, 1, 0}, side, side, kFocal_px);
}

// Weight of a lumigraph, not normalised, by its angles.
double penalised(double angle_deg, double bound_deg) { return (1 - angle_deg / bound_deg) / angle_deg; }

TEST(CamerasTowards, ShiftedLensesLookThroughTheirPictures) {
  std::vector<PinholeCamera> cameras;
  for (const double azimuth_deg : {-40.0, 0.0, 40.0}) cameras.push_back(onArc(azimuth_deg));
  const auto nearest = [&](double azimuth_deg) {
    const render::View view = render::viewFromCamera(onArc(azimuth_deg));
    return render::camerasTowards(cameras, render::viewAxis(view.clip_from_world), 2);
  };
  const std::vector<size_t> right{2, 1}, left{0, 1};
  EXPECT_EQ(nearest(35), right);
  EXPECT_EQ(nearest(-35), left);
  for (PinholeCamera& camera : cameras) camera = withShiftedLens(camera, 50 * kDegree);
  EXPECT_EQ(nearest(35), right);
  EXPECT_EQ(nearest(-35), left);
}

class CamerasWeightsTest : public CameraFigure {
 protected:
  void setMethod(const char* name, int closest) {
    recipe_->setMethod(render::makeCameraMethod(*device, name).take());
    options_.method.closest = closest;
  }

  // Wall seen by cameras at these azimuths, with a picture of one colour each.
  void makeWall(const std::vector<double>& azimuths_deg, const std::vector<glm::u8vec4>& colors) {
    addQuad({0, 1, 0}, 0.5, 3);
    std::vector<Image> pictures;
    std::vector<glm::ivec2> at;
    for (size_t c = 0; c < azimuths_deg.size(); ++c) {
      cameras_.push_back(onArc(azimuths_deg[c]));
      pictures.push_back(filled(cameras_[c], colors[c]));
      at.emplace_back(c % 3 * 70, c / 3 * 70);
    }
    makeModel();
    tile(pictures, at);
  }

  void hideFrom(double azimuth_deg) {
    const double a = azimuth_deg * kDegree;
    addQuad({1.5 * std::sin(a), 1, 1.5 * std::cos(a)}, 0.1);
    makeModel();
  }

  glm::vec3 middle(double azimuth_deg) {
    const uint8_t* p = still(onArc(azimuth_deg, kViewSide)).at(kViewSide / 2, kViewSide / 2);
    return {p[0], p[1], p[2]};
  }

  // Two cameras at ±20 degrees, whose pictures have stripes with a period of 4 pixels.
  void makeStripes(bool vertical) {
    addQuad({0, 1, 0}, 0.5, 3);
    cameras_ = {onArc(-20), onArc(20)};
    std::vector<Image> pictures(2, Image(kSide, kSide, 4, 255));
    for (Image& picture : pictures)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
          for (int k = 0; k < 3; ++k) picture.at(x, y)[k] = (vertical ? x : y) % 4 < 2 ? 0 : 255;
    makeModel();
    tile(pictures, {{0, 0}, {70, 0}});
    // The view ray's segment within the uncertainty spans one period in a camera at 20 degrees.
    options_.method.depth_uncertainty_m = float(4 * kDistance_m / kFocal_px / (2 * std::sin(20 * kDegree)));
  }

  // Maximum minus minimum brightness in the middle of the wall.
  int contrast(const char* method, double azimuth_deg) {
    setMethod(method, 2);
    const Image picture = still(onArc(azimuth_deg, kViewSide));
    int low = 255, high = 0;
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) {
        const int value = picture.at(kViewSide / 2 + i, kViewSide / 2 + j)[0];
        low = std::min(low, value), high = std::max(high, value);
      }
    return high - low;
  }
};

const std::vector<glm::u8vec4> kColors = {{250, 0, 0, 255}, {0, 250, 0, 255}, {0, 0, 250, 255}, {250, 250, 250, 255}};

TEST_F(CamerasWeightsTest, LumigraphWeighsByAnglesAndTheNextCameraBoundsThem) {
  makeWall({-30, 20, 45, 70}, kColors);
  setMethod("lumigraph", 3);
  glm::dvec3 weights(penalised(30, 70), penalised(20, 70), penalised(45, 70));
  glm::vec3 shown = middle(0);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(shown[k], 250 * weights[k] / (weights.x + weights.y + weights.z), 1.5) << k;

  hideFrom(70);
  EXPECT_LE(glm::length(middle(0) - shown), 1.5f) << "a camera at the bound has no weight that could be missed";

  hideFrom(20);
  shown = middle(0);
  weights.y = 0;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(shown[k], 250 * weights[k] / (weights.x + weights.z), 1.5) << k;

  hideFrom(-30);
  hideFrom(45);
  options_.method.unseen = render::Unseen::Transparent;
  EXPECT_EQ(still(onArc(0, kViewSide)).at(kViewSide / 2, kViewSide / 2)[3], 0);
}

TEST_F(CamerasWeightsTest, LumigraphOfAllCamerasIsBoundedByTheOppositeDirection) {
  makeWall({-30, 20, 45}, {kColors.begin(), kColors.begin() + 3});
  setMethod("lumigraph", 0);
  const glm::dvec3 weights(penalised(30, 180), penalised(20, 180), penalised(45, 180));
  const glm::vec3 shown = middle(0);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(shown[k], 250 * weights[k] / (weights.x + weights.y + weights.z), 1.5) << k;
}

TEST_F(CamerasWeightsTest, TheOnlyCameraThatSeesAPointIsShownThoughItIsTheBound) {
  makeWall({-30, 60}, {kColors[0], kColors[1]});
  hideFrom(-30);
  setMethod("lumigraph", 1);
  EXPECT_NEAR(middle(0).g, 250, 1.5);
}

// Half-way between two cameras, one enters the choice and another leaves it.
TEST_F(CamerasWeightsTest, LumigraphDoesNotJumpWhereACameraEntersTheChoice) {
  makeWall({-60, -30, 0, 30, 60},
           {{250, 0, 0, 255}, {0, 250, 0, 255}, {0, 0, 250, 255}, {250, 250, 0, 255}, {0, 250, 250, 255}});
  const auto jump = [&](double azimuth_deg) {
    return glm::length(middle(azimuth_deg + 0.02) - middle(azimuth_deg - 0.02));
  };
  setMethod("fvvr", 2);
  EXPECT_GT(jump(0), 50) << "the second camera changes at full weight";
  setMethod("lumigraph", 2);
  for (const double azimuth_deg : {-15.0, 0.0, 15.0, 30.0}) EXPECT_LE(jump(azimuth_deg), 2.5) << azimuth_deg;
}

TEST_F(CamerasWeightsTest, BandLimitedPictureOfFineStripesIsGreyFromWhereverOneLooks) {
  makeStripes(true);
  EXPECT_GT(contrast("lumigraph", -20), 150);
  EXPECT_LT(contrast("band-limited", -20), 40);
  EXPECT_LT(contrast("band-limited", 0), 40);
  options_.method.depth_uncertainty_m = 0;
  EXPECT_EQ(contrast("band-limited", 5), contrast("lumigraph", 5)) << "on an exact surface nothing is blurred";
}

TEST_F(CamerasWeightsTest, FilteredIsSharpFromACameraAndBlursAlongTheViewsRayBetweenThem) {
  makeStripes(true);
  EXPECT_GT(contrast("filtered", -20), 150);
  EXPECT_LT(contrast("filtered", 0), 50);
}

TEST_F(CamerasWeightsTest, FilteredDoesNotBlurAcrossTheViewsRay) {
  makeStripes(false);
  EXPECT_GT(contrast("filtered", 0), 120);
  EXPECT_LT(contrast("band-limited", 0), 40);
}

TEST_F(CamerasWeightsTest, EveryNameMakesAMethod) {
  EXPECT_EQ(render::cameraMethodNames(render::MethodGroup::Textured).front(), render::kDefaultMethod);
  for (const render::MethodGroup group : {render::MethodGroup::Textured, render::MethodGroup::Inspection})
    for (const std::string& name : render::cameraMethodNames(group))
      EXPECT_TRUE(render::makeCameraMethod(*device, name)) << name;
}

TEST(CameraMethods, WhereADeviceCannotRunOneTheLumigraphServesAndANoticeSaysSo) {
  const auto able = gpu::createNullDevice(true), unable = gpu::createNullDevice(false);
  std::vector<std::string> replaced;
  for (const render::MethodGroup group : {render::MethodGroup::Textured, render::MethodGroup::Inspection})
    for (const std::string& name : render::cameraMethodNames(group)) {
      const auto wanted = render::makeSupportedMethod(*able, name).take();
      EXPECT_EQ(wanted.name, name);
      EXPECT_EQ(wanted.notice, "");
      const auto served = render::makeSupportedMethod(*unable, name).take();
      ASSERT_TRUE(served.method) << name;
      if (served.name == name) continue;
      replaced.push_back(name);
      EXPECT_EQ(served.name, "lumigraph");
      EXPECT_EQ(served.notice,
                "this device cannot draw into half-float textures: lumigraph is drawn in place of " + name);
      EXPECT_EQ(render::makeCameraMethod(*unable, name).error().id, ErrorId::Unsupported);
    }
  EXPECT_EQ(replaced, (std::vector<std::string>{"linear", "floating", "floating-pairs", "floating-static", "montage4d",
                                                "montage4d-seams", "montage4d-weights"}));
  EXPECT_EQ(render::makeSupportedMethod(*unable, "no-such-method").error().id, ErrorId::InvalidArgument);
}

}  // namespace
}  // namespace fourdvt::testing
