// SPDX-License-Identifier: Apache-2.0
// Effects of the studio's knobs on a whole capture, as read by its reader.
#include <algorithm>
#include <cmath>

#include "capture/capture.h"
#include "capture/pictures.h"
#include "lab/studio/set.h"
#include "mattes/frame_reader.h"
#include "platform/ffmpeg_video.h"
#include "studio_fixture.h"

namespace fourdvt::studio {
namespace {

class StudioKnobsTest : public StudioTest {
 protected:
  // One motion of 6 frames.
  StudioOptions walk(const std::string& name) const {
    StudioOptions o = small(name);
    o.sequences = {"walk"};
    o.truth_at.clear();
    return o;
  }
};

TEST_F(StudioKnobsTest, FirstFramesOfAClipAreThoseOfTheWhole) {
  StudioOptions o = small("whole");
  o.truth_at.clear();
  ASSERT_TRUE(run(o));
  const auto whole = filesOf(o.folder);
  o.folder = folder_ + "/cut";
  o.frames = 2;
  auto report = run(o);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report.value().frames, 4u);
  const auto cut = filesOf(o.folder);
  EXPECT_TRUE(cut.at("walk/cam01/000001.png") == whole.at("walk/cam01/000001.png"));
  EXPECT_EQ(cut.count("walk/cam01/000002.png"), 0u);
  auto capture = mattes::openCapture(o.folder, platform::openVideoFile);
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_TRUE(capture.value().classes.empty());
  for (const capture::CaptureSequence& sequence : capture.value().sequences) {
    EXPECT_EQ(sequence.frame_count, 2u);
    EXPECT_FALSE(sequence.loop);
  }
}

TEST_F(StudioKnobsTest, RoomMayHaveNoPlates) {
  StudioOptions o = walk("bare");
  o.room = true;
  o.plates = 0;
  o.frames = 1;
  ASSERT_TRUE(run(o));
  const auto files = filesOf(o.folder);
  EXPECT_FALSE(fs::exists(o.folder + "/background"));
  EXPECT_EQ(files.at("capture.json").find("\"background\""), std::string::npos);
  EXPECT_EQ(files.count("mattes_true/walk/mask00/000000.png"), 1u);
}

// Ratio of a picture's upper left corner, which shows the backdrop, to the plate's.
glm::dvec3 gainOfCorner(const std::string& picture, const std::string& plate) {
  const Image a = capture::readPicture(picture, 3).take(), b = capture::readPicture(plate, 3).take();
  glm::dvec3 above(0), below(0);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x)
      for (int c = 0; c < 3; ++c) above[c] += a.at(x, y)[c], below[c] += b.at(x, y)[c];
  return above / below;
}

TEST_F(StudioKnobsTest, PicturesDriftAndPlatesDoNot) {
  StudioOptions o = walk("still");
  ASSERT_TRUE(run(o));
  const auto still = filesOf(o.folder);
  o.folder = folder_ + "/drifting";
  o.knobs.exposure_drift_percent = 20;
  ASSERT_TRUE(run(o));
  const auto drifting = filesOf(o.folder);
  std::vector<double> greens;
  for (const char* camera : {"cam00", "cam01", "cam02"}) {
    const std::string plate = std::string("background/") + camera + ".png";
    EXPECT_TRUE(drifting.at(plate) == still.at(plate));
    for (int frame = 0; frame < 6; ++frame) {
      const std::string picture = std::string("walk/") + camera + "/00000" + std::to_string(frame) + ".png";
      const glm::dvec3 gain = gainOfCorner(o.folder + "/" + picture, o.folder + "/" + plate);
      EXPECT_NEAR(gain.x, gain.y, 0.02);  // red has 46 levels
      EXPECT_LT(std::abs(gain.y - 1), 0.205);
      greens.push_back(gain.y);
    }
  }
  const auto [low, high] = std::minmax_element(greens.begin(), greens.end());
  EXPECT_GT(*high - *low, 0.2);
}

TEST_F(StudioKnobsTest, PlatesMoveAndPicturesDoNot) {
  StudioOptions o = walk("still");
  o.room = true;
  o.frames = 1;
  ASSERT_TRUE(run(o));
  const auto still = filesOf(o.folder);
  o.knobs.plate_move_pixels = 2;
  ASSERT_TRUE(run(o));
  const auto moved = filesOf(o.folder);
  EXPECT_TRUE(moved.at("walk/cam01/000000.png") == still.at("walk/cam01/000000.png"));
  EXPECT_FALSE(moved.at("background/cam01.png") == still.at("background/cam01.png"));
}

TEST_F(StudioKnobsTest, ShadowsSoften) {
  StudioOptions o = walk("hard");
  o.room = true;
  o.frames = 1;
  ASSERT_TRUE(run(o));
  const auto hard = filesOf(o.folder);
  o.knobs.soft_shadow_m = 0.1;
  ASSERT_TRUE(run(o));
  const auto soft = filesOf(o.folder);
  EXPECT_FALSE(soft.at("walk/cam01/000000.png") == hard.at("walk/cam01/000000.png"));
  EXPECT_TRUE(soft.at("background/cam01.png") == hard.at("background/cam01.png"));
}

std::vector<double> numbersAfter(const std::string& text, const std::string& key) {
  std::vector<double> out;
  std::stringstream rest(text.substr(text.find('[', text.find(key)) + 1));
  for (double value; rest >> value; rest.ignore(1)) out.push_back(value);
  return out;
}

// Poses and draws the set at the written offset, for comparison.
TEST_F(StudioKnobsTest, CamerasShowTheActorAtTheirOwnTimes) {
  StudioOptions o = walk("offset");
  o.knobs.offset_frames = 0.6;
  ASSERT_TRUE(run(o));
  const auto files = filesOf(o.folder);
  const std::vector<double> offsets = numbersAfter(files.at("capture.json"), "offset_frames_true");
  ASSERT_EQ(offsets.size(), 3u);
  EXPECT_NE(offsets[0], offsets[1]);
  auto set = StudioSet::open(o, *device);
  ASSERT_TRUE(set);
  for (size_t c = 0; c < 3; ++c)
    for (const int frame : {0, 4}) {
      const double phase = (frame + offsets[c]) / 6;
      set.value()->pose({1}, phase < 0 ? phase + 1 : phase);
      const Image drawn = set.value()->draw(set.value()->rig().ring[c]).take();
      const std::string file = "/walk/mask0" + std::to_string(c) + "/00000" + std::to_string(frame) + ".png";
      const Image matte = capture::readPicture(o.folder + file, 1).take();
      size_t different = 0;
      for (size_t i = 0; i < matte.pixels.size(); ++i)
        different += std::abs(matte.pixels[i] - drawn.pixels[4 * i + 3]) > 1;
      EXPECT_EQ(different, 0u) << file;
    }
  o.folder = folder_ + "/plain";
  o.knobs.offset_frames = 0;
  ASSERT_TRUE(run(o));
  const auto plain = filesOf(o.folder);
  EXPECT_EQ(plain.at("capture.json").find("offset"), std::string::npos);
  EXPECT_TRUE(plain.at("walk/mesh/positions.i16") == files.at("walk/mesh/positions.i16"));
  EXPECT_TRUE(plain.at("walk/test00/0002.png") == files.at("walk/test00/0002.png"));
  EXPECT_FALSE(plain.at("walk/mask00/000001.png") == files.at("walk/mask00/000001.png"));
}

// The reader undistorts with the written coefficients: it returns the pinhole picture, except for resampling.
TEST_F(StudioKnobsTest, FilmedThroughALensAndUndistortedAreTheSame) {
  StudioOptions o = walk("pinhole");
  o.frames = 1;
  o.width = 240;
  o.height = 320;
  const auto first = [&](const StudioOptions& options) {
    EXPECT_TRUE(run(options));
    const auto capture = mattes::openCapture(options.folder, platform::openVideoFile).take();
    return mattes::FrameReader::open(capture, capture.sequences[0], platform::openVideoFile).take()->next().take();
  };
  const mattes::CaptureFrame pinhole = first(o);
  o.folder = folder_ + "/lens";
  o.knobs.lens = {-0.25, 0.1, 0.5};
  const mattes::CaptureFrame lens = first(o);
  const auto files = filesOf(o.folder), plain = filesOf(folder_ + "/pinhole");
  EXPECT_NE(files.at("cameras/cameras.txt").find("FULL_OPENCV 240"), std::string::npos);
  EXPECT_NE(files.at("cameras_true/cameras.txt").find("FULL_OPENCV 240"), std::string::npos);
  EXPECT_EQ(files.at("cameras_test/cameras.txt").find("OPENCV 240"), std::string::npos);
  EXPECT_TRUE(files.at("walk/test00/0000.png") == plain.at("walk/test00/0000.png"));
  EXPECT_FALSE(files.at("walk/mask00/000000.png") == plain.at("walk/mask00/000000.png"));
  for (size_t c = 0; c < 3; ++c) {
    size_t different = 0, inside = 0;
    for (size_t i = 3; i < lens.pictures[c].pixels.size(); i += 4) {
      const int a = lens.pictures[c].pixels[i], b = pinhole.pictures[c].pixels[i];
      different += std::abs(a - b) > 128;
      inside += b >= 128;
    }
    EXPECT_LT(double(different), 0.003 * double(inside)) << c;
  }
}

TEST_F(StudioKnobsTest, BystanderIsBehindTheRingInOneOrTwoCameras) {
  const BoundingBox box{{-0.5f, 0, -0.5f}, {0.5f, 1.8f, 0.5f}};
  for (const int cameras : {5, 6, 8, 12}) {
    const Rig rig = makeRig(box, cameras, 96, 128);
    const glm::dvec3 eye = rig.ring[0].centreInWorld();
    auto bystander = Bystander::create(*device, rig, 0, 3, rig.ring[0]);
    ASSERT_TRUE(bystander) << bystander.error().message;
    bystander.value()->pose(0.4);
    for (const glm::vec3& p : bystander.value()->positions())
      ASSERT_GT(std::hypot(p.x, p.z), std::hypot(eye.x, eye.z)) << cameras;
    int see_it = 0;
    for (const PinholeCamera& camera : rig.ring) {
      const Image drawn = bystander.value()->draw(camera).take();
      int covered = 0;
      for (size_t i = 3; i < drawn.pixels.size(); i += 4) covered += drawn.pixels[i] > 127;
      see_it += covered > 50;
      EXPECT_TRUE(covered == 0 || covered > 50) << cameras << " " << camera.name << " " << covered;
    }
    EXPECT_GE(see_it, 1) << cameras;
    EXPECT_LE(see_it, 2) << cameras;
  }
}

// Behind the performer the bystander has other colours; elsewhere it adds at most a shadow.
TEST_F(StudioKnobsTest, BystanderIsInPicturesOnly) {
  StudioOptions o = walk("alone");
  o.room = true;
  o.frames = 1;
  ASSERT_TRUE(run(o));
  const std::string alone_folder = o.folder;
  const auto alone = filesOf(o.folder);
  o.folder = folder_ + "/two";
  o.bystander = true;
  ASSERT_TRUE(run(o));
  for (const auto& [name, bytes] : filesOf(o.folder)) {
    if (name == "capture.json" || name.starts_with("walk/cam")) continue;
    EXPECT_TRUE(alone.at(name) == bytes) << name;
  }
  auto set = StudioSet::open(o, *device).take();
  set->bystander()->pose(0);
  int covered = 0, darker = 0;
  for (const PinholeCamera& camera : set->rig().ring) {
    const Image drawn = set->bystander()->draw(camera).take();
    const auto picture = [&](const std::string& folder) {
      return capture::readPicture(folder + "/walk/" + camera.name + "/000000.png", 3).take();
    };
    const Image one = picture(alone_folder), two = picture(o.folder);
    const std::string mask = "/mattes_true/walk/" + capture::matteStem(camera.name) + "/000000.png";
    const Image matte = capture::readPicture(o.folder + mask, 1).take();
    for (size_t i = 0; i < matte.pixels.size(); ++i) {
      const int alpha = drawn.pixels[4 * i + 3];
      if (matte.pixels[i] > 0 || (alpha > 0 && alpha < 255)) continue;
      covered += alpha == 255;
      darker += alpha == 0 && two.pixels[3 * i] < one.pixels[3 * i];
      for (size_t c = 0; c < 3; ++c) {
        const int level = two.pixels[3 * i + c];
        ASSERT_TRUE(alpha > 0 || level <= one.pixels[3 * i + c]) << camera.name << " " << i;
        ASSERT_TRUE(alpha == 0 || level == drawn.pixels[4 * i + c]) << camera.name << " " << i;
      }
    }
  }
  EXPECT_GT(covered, 50);
  EXPECT_GT(darker, 5);
}

// Scales the world: every mesh point keeps its place in every picture.
TEST_F(StudioKnobsTest, ScaledWorldLooksTheSame) {
  StudioOptions o = small("one");
  o.truth_at = {0.5};
  o.room = true;
  ASSERT_TRUE(run(o));
  const auto one_files = filesOf(o.folder);
  const auto one = mattes::openCapture(o.folder, platform::openVideoFile).take();
  for (const double scale : {0.05, 20.0}) {
    o.folder = folder_ + "/scaled";
    o.scale = scale;
    ASSERT_TRUE(run(o));
    const auto files = filesOf(o.folder);
    for (const auto& [name, bytes] : one_files) {
      if (!name.ends_with(".png") && !name.ends_with(".i16")) continue;
      EXPECT_TRUE(files.at(name) == bytes) << name;
    }
    auto opened = mattes::openCapture(o.folder, platform::openVideoFile);
    ASSERT_TRUE(opened) << opened.error().message;
    const capture::Capture& scaled = opened.value();
    const Positions small = capture::readMeshFrame(one, one.sequences[1], 2).take();
    const Positions large = capture::readMeshFrame(scaled, scaled.sequences[1], 2).take();
    ASSERT_NEAR(glm::length(large[5]) / glm::length(small[5]), scale, 1e-4 * scale);
    for (size_t c = 0; c < one.cameras.size(); ++c)
      for (size_t v = 0; v < small.size(); v += 50) {
        const glm::dvec3 before = one.cameras[c].pinhole.project(small[v]);
        const glm::dvec3 after = scaled.cameras[c].pinhole.project(large[v]);
        ASSERT_NEAR(glm::distance(glm::dvec2(before), glm::dvec2(after)), 0, 1e-3);
        ASSERT_NEAR(after.z / before.z, scale, 1e-5 * scale);
      }
    EXPECT_NEAR(scaled.sequences[1].root_velocity_mps.z, 2.6 * scale, 1e-9);
    EXPECT_NEAR(scaled.ground_y_m, one.ground_y_m * scale, 1e-9);
    EXPECT_NEAR(scaled.room->max.x, one.room->max.x * scale, 1e-3 * scale);
    EXPECT_NEAR(capture::readTestCameras(scaled).take()[1].centreInWorld().y,
                capture::readTestCameras(one).take()[1].centreInWorld().y * scale, 1e-6 * scale);
    const auto truth_one = capture::readColmapCameras(folder_ + "/one/truth/locomotion/cameras").take();
    const auto truth = capture::readColmapCameras(o.folder + "/truth/locomotion/cameras").take();
    EXPECT_NEAR(truth[0].pinhole.centreInWorld().x, truth_one[0].pinhole.centreInWorld().x * scale, 1e-6 * scale);
  }
}

TEST_F(StudioKnobsTest, RoomMustHoldTheCameras) {
  StudioOptions o = walk("room");
  o.room = true;
  o.frames = 1;
  o.room_size_m = 3;
  const auto refused = run(o);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().id, ErrorId::InvalidArgument);
  o.room_size_m = 15;
  ASSERT_TRUE(run(o));
  auto capture = mattes::openCapture(o.folder, platform::openVideoFile);
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_TRUE(capture.value().room);
  EXPECT_EQ(capture.value().room->max.x, 7.5f);
  EXPECT_EQ(capture.value().room->min.z, -7.5f);
}

}  // namespace
}  // namespace fourdvt::studio
