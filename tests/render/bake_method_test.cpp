// SPDX-License-Identifier: Apache-2.0
// Method trials with left-out cameras: a wall behind the given surface, with exact and with rotated cameras.
#include "bake/method/method_trial.h"
#include "gl_fixture.h"
#include "look_at.h"
#include "wall_pictures.h"

namespace fourdvt::testing {
namespace {

constexpr int kWidth = 200, kHeight = 160;
const std::vector<std::string> kMethods{"fvvr", "linear", "sweep"};

// Grid of quads at z = 0, ±.35 m about (0, 1, 0).
TriangleMesh grid() {
  TriangleMesh out;
  constexpr uint32_t kCells = 6;
  for (uint32_t y = 0; y <= kCells; ++y)
    for (uint32_t x = 0; x <= kCells; ++x)
      out.positions.emplace_back(0.7f * float(x) / kCells - 0.35f, 1.35f - 0.7f * float(y) / kCells, 0);
  for (uint32_t y = 0; y < kCells; ++y)
    for (uint32_t x = 0; x < kCells; ++x) {
      const uint32_t a = y * (kCells + 1) + x, b = a + kCells + 1;
      out.faces.push_back({a, b, b + 1});
      out.faces.push_back({a, b + 1, a + 1});
    }
  return out;
}

// Picture of the wall, with a matte that ends at the grid's border.
Image pictureOf(const PinholeCamera& camera, double depth_m) {
  Image out = wall(camera, depth_m);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const glm::dvec3 ray = glm::transpose(glm::dmat3(camera.cam_from_world)) *
                             glm::dvec3((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
      const glm::dvec3 centre = camera.centreInWorld(), at = centre - centre.z / ray.z * ray;
      if (std::abs(at.x) > 0.34 || std::abs(at.y - 1) > 0.34) out.at(x, y)[3] = 0;
    }
  return out;
}

class MethodTrial : public GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    for (const double x : {-1.2, -0.6, 0.0, 0.6, 1.2})
      cameras_.push_back(lookAt({x, 1.1, 2}, {0, 1, 0}, kWidth, kHeight, 440));
    for (const PinholeCamera& camera : cameras_) pictures_.push_back(pictureOf(camera, -0.012));
  }

  bake::TrialSums tried(const std::vector<PinholeCamera>& cameras) {
    const bake::TrialFrame frame{cameras, surface_, pictures_};
    const auto drawing = bake::FrameDrawing::create(*device, cameras).take();
    EXPECT_TRUE(drawing->setFrame(surface_, pictures_));
    auto sums = bake::tryMethods(*device, *drawing, frame, bake::trialCameras(frame), kMethods);
    EXPECT_TRUE(sums.ok());
    return sums.ok() ? sums.take() : bake::TrialSums{};
  }
  std::string chosen(const bake::TrialSums& sums) const {
    return bake::chooseMethod(bake::meanScores(sums, surface_.faces.size()), bake::meanViews(sums)).method;
  }
  // Cameras rotated by some pixels each, in different directions.
  std::vector<PinholeCamera> turned(double pixels) const {
    std::vector<PinholeCamera> out = cameras_;
    for (size_t c = 0; c < out.size(); ++c) {
      const double angle = 2.4 * double(c);
      out[c].cx += pixels * std::cos(angle), out[c].cy += pixels * std::sin(angle);
    }
    return out;
  }

  const TriangleMesh surface_ = grid();
  std::vector<PinholeCamera> cameras_;
  std::vector<Image> pictures_;
};

TEST_F(MethodTrial, ExactCamerasGetTheSharperMethodAndTurnedOnesTheRobustOne) {
  const bake::TrialSums exact = tried(cameras_), off = tried(turned(4));
  ASSERT_GE(exact.views, 3u) << "those in the middle are between two others";
  EXPECT_LT(exact.shift_px / double(exact.views), 1);
  EXPECT_GT(exact.scores[2].psnr_db - exact.scores[0].psnr_db, double(exact.views)) << "sweep against fvvr, 1 dB";
  EXPECT_EQ(chosen(exact), "sweep");
  EXPECT_GT(off.shift_px / double(off.views), 3);
  EXPECT_NE(chosen(off), "sweep");
}

TEST_F(MethodTrial, FramesAddUpAndTheSameInputGivesTheSameSums) {
  const bake::TrialSums one = tried(cameras_), again = tried(cameras_);
  bake::TrialSums both;
  add(one, both);
  add(again, both);
  EXPECT_EQ(both.views, 2 * one.views);
  for (size_t m = 0; m < kMethods.size(); ++m) {
    EXPECT_EQ(one.scores[m].psnr_db, again.scores[m].psnr_db);
    EXPECT_EQ(both.scores[m].psnr_db, one.scores[m].psnr_db + again.scores[m].psnr_db);
    EXPECT_EQ(bake::meanScores(both, 72)[m].ssim, bake::meanScores(one, 72)[m].ssim);
  }
}

TEST_F(MethodTrial, ACameraWithoutAMatteIsNotLeftOut) {
  for (size_t i = 3; i < pictures_[2].pixels.size(); i += 4) pictures_[2].pixels[i] = 0;
  const bake::TrialFrame frame{cameras_, surface_, pictures_};
  EXPECT_EQ(bake::trialCameras(frame), (std::vector<size_t>{0, 1, 3, 4}));
}

TEST_F(MethodTrial, TwoCamerasLeaveNothingToBlend) {
  cameras_.resize(2), pictures_.resize(2);
  const bake::TrialFrame frame{cameras_, surface_, pictures_};
  EXPECT_TRUE(bake::trialCameras(frame).empty());
  EXPECT_EQ(tried(cameras_).views, 0u);
}

TEST_F(MethodTrial, LargePicturesAreComparedSmaller) {
  for (PinholeCamera& camera : cameras_) camera = scaledCamera(camera, 8 * kWidth, 8 * kHeight);
  cameras_.resize(3);
  pictures_.clear();
  for (const PinholeCamera& camera : cameras_) pictures_.push_back(pictureOf(camera, -0.012));
  const bake::TrialFrame frame{cameras_, surface_, pictures_};
  const auto drawing = bake::FrameDrawing::create(*device, cameras_).take();
  ASSERT_TRUE(drawing->setFrame(surface_, pictures_));
  const size_t middle = 1;
  const auto sums = bake::tryMethods(*device, *drawing, frame, {&middle, 1}, {"fvvr"});
  ASSERT_TRUE(sums.ok()) << sums.error().message;
  EXPECT_EQ(sums.value().views, 1u);
  EXPECT_GT(sums.value().scores[0].psnr_db, 15);
}

}  // namespace
}  // namespace fourdvt::testing
