// SPDX-License-Identifier: Apache-2.0
// The refinement on the sample capture, whose mesh lies about 2 mm outside the performer (its README), and on rotated
// cameras. Bounds are tight: without the refinement, or with its sign reversed, the first test fails at every check.
#include <map>

#include "bake/texels/picture_crop.h"
#include "capture/capture.h"
#include "gl_fixture.h"
#include "lab/measure/held_out_truth.h"
#include "mattes/frame_reader.h"
#include "measure/picture_score.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "refine/camera_fit.h"
#include "refine/refine.h"
#include "render/cameras/fvvr.h"
#include "store/folder.h"

namespace fourdvt::refine {
namespace {

const std::string kSample = std::string(FOURDVT_SOURCE_DIR) + "/site/sample/actor_a";
constexpr double kDegrees = 180 / 3.14159265358979323846;

bool goOn(const std::string&, double) { return true; }

capture::Capture sampleRun() {
  auto capture = mattes::openCapture(kSample, platform::openVideoFile, {"run"});
  EXPECT_TRUE(capture.ok()) << capture.error().message;
  return capture.take();
}

// Combined into one test: refining takes seconds, and each test runs in its own process.
struct RefineSample : testing::GlFixture {
  static Refinement refine(const capture::Capture& capture) {
    auto result = refineCapture(capture, platform::openVideoFile, {}, goOn);
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.take();
  }

  // Score of FVVR at the held-out cameras, frame 8 of the run.
  measure::PictureScore heldOut(const capture::Capture& capture) {
    const capture::CaptureSequence& sequence = capture.sequences[0];
    auto reader = mattes::FrameReader::open(capture, sequence, platform::openVideoFile, 8).take();
    auto frame = reader->next().take();
    for (Image& picture : frame.pictures) bake::replaceEdgeColours(picture);
    std::vector<PinholeCamera> cameras;
    for (const auto& camera : capture.cameras) cameras.push_back(camera.pinhole);
    auto fvvr = render::Fvvr::create(*device, cameras, capture.topology).take();
    EXPECT_TRUE(fvvr->setFrame(frame.positions, frame.pictures).ok());
    measure::MeanScores mean;
    for (const PinholeCamera& camera : capture::readTestCameras(capture).take())
      mean.add(measure::scorePicture(measure::heldOutTruth(sequence, camera, 8).take(),
                                     fvvr->renderStill(render::viewFromCamera(camera), {}).take()));
    return mean.mean();
  }
};

void expectOutlinesOnMattes(const Refinement& refinement) {
  for (const CameraRefinement& camera : refinement.by_camera) {
    EXPECT_NEAR(camera.before.bias_pixels, -0.72, 0.2) << camera.name;  // the mesh is too large
    EXPECT_NEAR(camera.after.bias_pixels, 0, 0.06) << camera.name;
    EXPECT_LT(camera.after.median_pixels, 0.27) << camera.name;
    EXPECT_LT(camera.after.p95_pixels, 0.75 * camera.before.p95_pixels) << camera.name;
    EXPECT_GT(camera.before.points, 5000u) << camera.name;
    // Expects unbiased mattes.
    ASSERT_TRUE(camera.measured_bias_pixels.has_value());
    EXPECT_NEAR(*camera.measured_bias_pixels, 0, 0.1) << camera.name;
    EXPECT_EQ(camera.used_bias_pixels, 0) << camera.name;
  }
  EXPECT_NEAR(refinement.offset_median_m, -0.0017, 0.0002);
  EXPECT_TRUE(refinement.note.empty());
}

void expectSameCameras(const Refinement& refinement, const capture::Capture& given) {
  EXPECT_FALSE(refinement.changedCameras());
  for (size_t c = 0; c < given.cameras.size(); ++c) {
    EXPECT_EQ(refinement.cameras[c].cam_from_world, given.cameras[c].pinhole.cam_from_world);
    EXPECT_EQ(refinement.cameras[c].fx, given.cameras[c].pinhole.fx);
    ASSERT_TRUE(refinement.by_camera[c].best.has_value());
    EXPECT_LT(refinement.by_camera[c].best->pixels, 0.2);
  }
}

// Expects pictures of different cameras that improved.
void expectWorstPictures(const Refinement& refinement) {
  ASSERT_EQ(refinement.worst.size(), 3u);
  for (const WorstPicture& view : refinement.worst) {
    EXPECT_LT(view.after.median_pixels, view.before.median_pixels);
    EXPECT_GT(view.picture.width, 100);
  }
  EXPECT_NE(refinement.worst[0].camera, refinement.worst[1].camera);
}

void expectKeptBytes(const Refinement& refinement, const capture::Capture& capture) {
  const std::string path = ::testing::TempDir() + "/kept.refinement";
  ASSERT_TRUE(store::save(path, refinement));
  const auto kept = loadRefinement(path, capture);
  ASSERT_TRUE(kept);
  const Refinement& read = kept.value();
  EXPECT_EQ(store::bytesOf(read), store::bytesOf(refinement));
  EXPECT_EQ(read.offsets->constant_m, refinement.offsets->constant_m);
  EXPECT_EQ(read.cameras[3].cam_from_world, refinement.cameras[3].cam_from_world);
  auto bytes = platform::readFile(path).take();
  const auto isRefused = [&](std::span<const uint8_t> part) {
    return platform::writeFileAtomic(path, part).ok() && !loadRefinement(path, capture);
  };
  for (const size_t length : {size_t(0), size_t(5), bytes.size() / 2, bytes.size() - 1})
    EXPECT_TRUE(isRefused(std::span(bytes).first(length)));
  bytes.push_back(0);
  EXPECT_TRUE(isRefused(bytes));
}

TEST_F(RefineSample, MeshAndTurnedCamerasComeToFitThePictures) {
  const capture::Capture given = sampleRun();
  const Refinement refinement = refine(given);
  expectOutlinesOnMattes(refinement);
  expectSameCameras(refinement, given);
  expectWorstPictures(refinement);

  const measure::PictureScore before = heldOut(given);
  capture::Capture refined = given;
  applyRefinement(refinement, refined);
  const measure::PictureScore after = heldOut(refined);
  EXPECT_NEAR(after.psnr_fg_db - before.psnr_fg_db, 2.05, 0.35);
  EXPECT_NEAR(after.ssim_fg - before.ssim_fg, 0.06, 0.02);

  // Rotates three cameras about their vertical axes; expects that only these are rotated back.
  const std::map<size_t, double> turns_deg{{1, 0.1}, {3, -0.3}, {6, 0.6}};
  capture::Capture turned = given;
  for (const auto& [c, turn] : turns_deg)
    turned.cameras[c].pinhole = changed(turned.cameras[c].pinhole, {{0, turn / kDegrees, 0}, {0, 0, 0}, 0});
  const Refinement back = refine(turned);
  for (size_t c = 0; c < given.cameras.size(); ++c) {
    const CameraRefinement& camera = back.by_camera[c];
    EXPECT_EQ(camera.changed, turns_deg.count(c) > 0) << camera.name;
    if (!turns_deg.count(c)) continue;
    EXPECT_NEAR(camera.turn_deg.y, -turns_deg.at(c), 0.012) << camera.name;
    EXPECT_LT(glm::length(camera.turn_deviation_deg), 0.05) << camera.name;
  }
  expectKeptBytes(back, turned);
  applyRefinement(back, turned);
  EXPECT_NEAR(heldOut(turned).psnr_fg_db, after.psnr_fg_db, 0.15);
}

TEST(RefineCapture, StopsWhenAsked) {
  const auto result =
      refineCapture(sampleRun(), platform::openVideoFile, {}, [](const std::string&, double) { return false; });
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().id, ErrorId::Interrupted);
}

}  // namespace
}  // namespace fourdvt::refine
