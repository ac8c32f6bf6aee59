// SPDX-License-Identifier: Apache-2.0
// The whole refinement on a small capture in files: a ball of half a metre, filmed in a studio with a green backdrop,
// whose mesh is 4 mm too large.
#include "refine/refine.h"

#include <gtest/gtest.h>

#include "capture_fixture.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "sphere_fixture.h"
#include "store/folder.h"

namespace fourdvt::refine {
namespace {

constexpr int kCameras = 6, kFrames = 3;
constexpr double kTooLarge_m = 0.004;
constexpr double kFacets_m = 0.0012;  // distance of the ball's vertices from it, if its faces fit the pictures

bool goOn(const std::string&, double) { return true; }

// A red ball in front of green, with mattes that may be too large by some pixels, or missing.
class BallCapture : public capture::TempFolder {
 public:
  explicit BallCapture(double matte_grown = 0, bool mattes = true, int cameras = kCameras,
                       double too_large_m = kTooLarge_m, double bump_m = 0) {
    write("capture.json", R"({"fps": 25, "sequences": [{"name": "still", "frames": 3, "loop": true}]})");
    std::vector<capture::CaptureCamera> ring;
    for (int c = 0; c < cameras; ++c) ring.push_back({ballCamera(c, kCameras), {}});
    for (auto& camera : ring) camera.pinhole.name = "cam0" + camera.pinhole.name.substr(3);
    const capture::ColmapText text = capture::colmapText(ring, 1);
    write("cameras/cameras.txt", text.cameras);
    write("cameras/images.txt", text.images);
    const Image matte = mattes ? ballMatte(matte_grown).alpha : Image(kBallPicture, kBallPicture, 1, 0);
    const MatteCrop truth = ballMatte();
    Image picture(kBallPicture, kBallPicture, 3);
    for (int i = 0; i < kBallPicture * kBallPicture; ++i) {
      const bool inside = truth.alpha.pixels[i] >= 128;
      picture.pixels[3 * i] = inside ? 200 : 20;
      picture.pixels[3 * i + 1] = inside ? 40 : 160;
      picture.pixels[3 * i + 2] = 30;
    }
    for (int frame = 0; frame < kFrames; ++frame) {
      for (const auto& camera : ring) {
        const std::string number = camera.pinhole.name.substr(3);
        write("still/cam" + number + "/" + capture::numbered(frame, ".png"), picture);
        write("still/mask" + number + "/" + capture::numbered(frame, ".png"), matte);
      }
      write("still/mesh/" + capture::numbered(frame, ".obj"), objText(too_large_m, bump_m));
    }
  }
  capture::Capture open() const {
    auto capture = mattes::openCapture(path(), platform::openVideoFile);
    EXPECT_TRUE(capture.ok()) << capture.error().message;
    return capture.take();
  }

 private:
  // The bump covers a quarter of the ball.
  static std::string objText(double too_large_m, double bump_m) {
    BallMesh mesh = ballMesh(kBallRadius_m + too_large_m, 3);
    std::string text;
    for (glm::vec3& p : mesh.positions)
      if (glm::normalize(p).z > 0.5f) p += static_cast<float>(bump_m) * glm::normalize(p);
    for (const glm::vec3& p : mesh.positions)
      text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    text += "vt 0 0\nvt 1 0\nvt 1 1\n";
    for (const glm::uvec3& f : mesh.faces)
      text +=
          "f " + std::to_string(f.x + 1) + "/1 " + std::to_string(f.y + 1) + "/2 " + std::to_string(f.z + 1) + "/3\n";
    return text;
  }
};

Refinement refine(const capture::Capture& capture, const RefineOptions& options) {
  auto result = refineCapture(capture, platform::openVideoFile, options, goOn);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.take();
}

double radiusAfter(const Refinement& refinement, capture::Capture capture) {
  applyRefinement(refinement, capture);
  const auto positions = capture::readMeshFrame(capture, capture.sequences[0], 1);
  double sum = 0;
  for (const glm::vec3& p : positions.value()) sum += glm::length(p);
  return sum / double(positions.value().size());
}

TEST(Refine, BallTakesItsTrueSize) {
  const BallCapture files;
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {});
  // The mesh's flat faces lie partly inside the ball, so that a fitting mesh is slightly larger than the ball.
  EXPECT_NEAR(radiusAfter(refinement, capture), kBallRadius_m, 0.0016);
  EXPECT_EQ(refinement.frames, uint32_t(kFrames));
  EXPECT_FALSE(refinement.changedCameras());
  EXPECT_TRUE(refinement.slow.empty());
}

TEST(Refine, AMeshThatCannotBeToldFromExactStaysAsGiven) {
  const BallCapture files(0, true, kCameras, kFacets_m);
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {});
  for (const CameraRefinement& camera : refinement.by_camera) {
    EXPECT_LT(camera.before.median_pixels, 0.25);
    EXPECT_EQ(camera.after.median_pixels, camera.before.median_pixels);
  }
  EXPECT_NEAR(radiusAfter(refinement, capture), kBallRadius_m + kFacets_m, 1e-6);
  EXPECT_NE(refinement.note.find("0.25 px"), std::string::npos);
  EXPECT_FALSE(refinement.changedCameras());
}

TEST(Refine, AMeshThatIsFarOffInPlacesIsNotCalledExact) {
  const BallCapture files(0, true, kCameras, kFacets_m, 0.005);
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {});
  EXPECT_GT(refinement.by_camera[1].before.p95_pixels, 1);
  EXPECT_EQ(refinement.note.find("0.25 px"), std::string::npos);
}

TEST(Refine, ErodedMattesAreCorrectedByThePictures) {
  const BallCapture files(-2);
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {});
  for (const CameraRefinement& camera : refinement.by_camera) {
    ASSERT_TRUE(camera.measured_bias_pixels.has_value());
    EXPECT_NEAR(*camera.measured_bias_pixels, -2, 0.3);
    EXPECT_EQ(camera.used_bias_pixels, *camera.measured_bias_pixels);
  }
  EXPECT_NEAR(radiusAfter(refinement, capture), kBallRadius_m, 0.0016);
}

TEST(Refine, BiasThatIsGivenIsUsedInstead) {
  const BallCapture files(-2);
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {.matte_bias_pixels = 0.0});
  EXPECT_EQ(refinement.by_camera[0].used_bias_pixels, 0);
  // Two pixels are 5 mm here.
  EXPECT_NEAR(radiusAfter(refinement, capture), kBallRadius_m - 2 * kBallDistance_m / kBallFocal, 0.0016);
}

TEST(Refine, OutlineOffLeavesTheMesh) {
  const BallCapture files;
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {.outline = false});
  EXPECT_EQ(refinement.offsets, nullptr);
  EXPECT_NEAR(radiusAfter(refinement, capture), kBallRadius_m + kTooLarge_m, 1e-4);
  EXPECT_TRUE(refinement.note.empty());
}

TEST(Refine, CamerasOffSaysNothingAboutThem) {
  const BallCapture files;
  const Refinement refinement = refine(files.open(), {.cameras = false});
  for (const CameraRefinement& camera : refinement.by_camera) EXPECT_FALSE(camera.best.has_value());
}

TEST(Refine, EmptyMattesAndASingleCameraLeaveTheMeshAndSaySo) {
  {
    const BallCapture files(0, false);
    const Refinement refinement = refine(files.open(), {});
    EXPECT_EQ(refinement.offsets, nullptr);
    EXPECT_NE(refinement.note.find("no camera has a matte edge"), std::string::npos) << refinement.note;
  }
  const BallCapture files(0, true, 1);
  const capture::Capture capture = files.open();
  const Refinement refinement = refine(capture, {});
  EXPECT_EQ(refinement.offsets, nullptr);
  EXPECT_FALSE(refinement.note.empty());
  const std::string path = testing::TempDir() + "/single_camera.refinement";
  ASSERT_TRUE(store::save(path, refinement));
  EXPECT_TRUE(loadRefinement(path, capture));
}

TEST(Refine, DamagedFilesAreRefused) {
  const BallCapture files;
  const capture::Capture capture = files.open();
  const std::string path = testing::TempDir() + "/damaged.refinement";
  ASSERT_TRUE(store::save(path, refine(capture, {.cameras = false})));
  ASSERT_TRUE(loadRefinement(path, capture));
  const auto bytes = platform::readFile(path).take();
  for (size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 50) {
    auto damaged = bytes;
    damaged[at] ^= 0x40;
    ASSERT_TRUE(platform::writeFileAtomic(path, damaged));
    EXPECT_FALSE(loadRefinement(path, capture)) << at;
  }
}

TEST(Refine, EveryStopIsHeeded) {
  const BallCapture files;
  const capture::Capture capture = files.open();
  int calls = 0;
  ASSERT_TRUE(refineCapture(capture, platform::openVideoFile, {}, [&](const std::string&, double) {
                ++calls;
                return true;
              }).ok());
  for (int stop = 0; stop < calls; stop += 2) {
    int left = stop;
    const auto result =
        refineCapture(capture, platform::openVideoFile, {}, [&](const std::string&, double) { return left-- > 0; });
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().id, ErrorId::Interrupted);
  }
}

}  // namespace
}  // namespace fourdvt::refine
