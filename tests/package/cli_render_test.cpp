// SPDX-License-Identifier: Apache-2.0
// Scenes and movies from the command line: compositing, and messages for invalid scenes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "command.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

const uint8_t kSky[3] = {40, 120, 200};

class SceneRendering : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = scratch("render");
    const std::string capture = smallCapture("render-capture", 6);
    baked_ =
        fourdvt("bake " + capture + " -o " + folder_ + "/box --texture 128 --layers 2 --gop 4 --renditions highest");
    fs::copy(capture + "/cameras", folder_ + "/cameras");
    Image sky(160, 160, 3);
    for (size_t i = 0; i < sky.pixels.size(); ++i) sky.pixels[i] = kSky[i % 3];
    EXPECT_TRUE(platform::writeImage(folder_ + "/sky.png", sky).ok());
    // Wall between the box and cam00: hides the lower half of the picture.
    writeText(folder_ + "/wall.obj", "v -3 -3 0.9\nv 3 -3 0.9\nv 3 0.65 0.9\nv -3 0.65 0.9\nf 1 2 3 4\n");
  }
  void SetUp() override { ASSERT_EQ(baked_.code, 0) << baked_.output; }

  // `more`: further members of the scene's JSON, with a leading comma.
  std::string scene(const std::string& more, const std::string& character = "") {
    const std::string path = folder_ + "/scene.json";
    writeText(path, R"({"camera": "cameras", "camera_name": "cam00", "characters": [{"src": "box")" + character + "}]" +
                        more + "}");
    return path;
  }
  Image still(const std::string& arguments) {
    const std::string path = folder_ + "/still.png";
    const Outcome outcome = fourdvt("render " + arguments + " -o " + path);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    auto image = platform::readImage(path);
    return image.ok() ? image.take() : Image();
  }
  static inline std::string folder_;
  static inline Outcome baked_;
};

int differing(const Image& a, const Image& b, int more_than) {
  int count = 0;
  for (size_t i = 0; i < a.pixels.size(); i += size_t(a.channels)) {
    int most = 0;
    for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.pixels[i + c] - b.pixels[i + c]));
    count += most > more_than;
  }
  return count;
}

bool isSky(const Image& image, int x, int y) {
  for (int c = 0; c < 3; ++c)
    if (std::abs(image.at(x, y)[c] - kSky[c]) > 2) return false;
  return true;
}

// A scene with only one character, at the origin, equals the plain still of the same camera.
TEST_F(SceneRendering, OfOneCharacterIsItsStill) {
  const Image plain = still(folder_ + "/box --camera cam00 --no-shadow --frame 3");
  const Image composed = still("--scene " + scene("") + " --no-shadow --frame 3");
  ASSERT_EQ(plain.pixels.size(), composed.pixels.size());
  EXPECT_EQ(differing(plain, composed, 1), 0);
  EXPECT_GT(differing(composed, Image(160, 160, 4), 30), 2000) << "there is something to see";
}

TEST_F(SceneRendering, OccludersShowTheBackground) {
  const Image open = still("--scene " + scene(R"(, "background": "sky.png")") + " --no-shadow");
  const Image hidden =
      still("--scene " + scene(R"(, "background": "sky.png", "occluders": ["wall.obj"])") + " --no-shadow");
  ASSERT_EQ(open.width, 160);
  EXPECT_TRUE(isSky(open, 2, 2));
  EXPECT_FALSE(isSky(open, 80, 50));
  EXPECT_FALSE(isSky(open, 80, 110));
  EXPECT_FALSE(isSky(hidden, 80, 50)) << "above the wall";
  EXPECT_TRUE(isSky(hidden, 80, 110)) << "behind it";
}

TEST_F(SceneRendering, CharactersStandWhereTheyArePut) {
  const std::string sky = R"(, "background": "sky.png")";
  const Image there = still("--scene " + scene(sky, R"(, "position": [50, 0])") + " --no-shadow");
  EXPECT_TRUE(isSky(there, 80, 80)) << "out of sight";
  const Image turned = still("--scene " + scene(sky, R"(, "heading_deg": 90)") + " --no-shadow");
  const Image straight = still("--scene " + scene(sky) + " --no-shadow");
  EXPECT_GT(differing(turned, straight, 40), 1000);
  writeText(folder_ + "/two.json", R"({"camera": "cameras", "camera_name": "cam00", "background": "sky.png",
    "characters": [{"src": "box", "position": [-0.5, 0]}, {"src": "box", "position": [0.5, 0]}]})");
  const Image two = still("--scene " + folder_ + "/two.json --no-shadow");
  EXPECT_FALSE(isSky(two, 60, 70));
  EXPECT_FALSE(isSky(two, 100, 70));
}

TEST_F(SceneRendering, MoviesHaveEveryFrame) {
  const auto pictures = [&](const std::string& arguments) {
    const std::string path = folder_ + "/movie.mp4";
    const Outcome outcome = fourdvt("render " + arguments + " -o " + path);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    auto video = platform::openVideoFile(path, 3);
    int count = 0;
    for (; video.ok(); ++count) {
      auto picture = video.value()->next();
      if (!picture.ok() || !picture.value()) break;
    }
    return count;
  };
  EXPECT_EQ(pictures(folder_ + "/box --play turn --seconds 0.6 --size 96x96 --travel --follow"), 15);
  EXPECT_EQ(pictures("--scene " + scene(R"(, "fps": 10, "seconds": 0.7, "size": [64, 64])")), 7);
}

TEST_F(SceneRendering, MessagesNameTheFile) {
  struct Wrong {
    std::string members, character, message;
  };
  for (const Wrong& wrong :
       {Wrong{R"(, "background": "none.png")", "", "none.png"}, Wrong{R"(, "occluders": ["none.obj"])", "", "none.obj"},
        Wrong{R"(, "ocluders": [])", "", "ocluders"}, Wrong{R"(, "size": [64])", "", "size"},
        Wrong{R"(, "background": "sky.png", "size": [64, 32])", "", "64x32"}, Wrong{R"(, "fps": "fast")", "", "fps"},
        Wrong{"", R"(, "state": "fly")", "turn"}, Wrong{"", R"(, "play": ["turn@soon"])", "turn@soon"},
        Wrong{"", R"(, "parameter": {"speed_mps": 2})", "speed_mps"}, Wrong{"", R"(, "position": [1])", "position"}}) {
    const Outcome outcome =
        fourdvt("render --scene " + scene(wrong.members, wrong.character) + " -o " + folder_ + "/x.png");
    EXPECT_EQ(outcome.code, 1) << outcome.output;
    EXPECT_TRUE(isOneLineWith(outcome, wrong.message)) << outcome.output;
    EXPECT_FALSE(exists(folder_ + "/x.png"));
  }
  writeText(folder_ + "/broken.json", "{\"characters\": [}");
  for (const char* name : {"broken.json", "missing.json"}) {
    const Outcome outcome = fourdvt("render --scene " + folder_ + "/" + name + " -o " + folder_ + "/x.png");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_TRUE(isOneLineWith(outcome, name)) << outcome.output;
  }
  const Outcome no_class = fourdvt("render " + folder_ + "/box --class turn -o " + folder_ + "/x.png");
  EXPECT_EQ(no_class.code, 1);
  EXPECT_TRUE(isOneLineWith(no_class, "--sequence")) << no_class.output;
  for (const char* options : {"--closest 3", "--visibility plain", "--method fvvr", "--method wireframe"}) {
    const Outcome layered = fourdvt("render " + folder_ + "/box " + options + " -o " + folder_ + "/x.png");
    EXPECT_EQ(layered.code, 1);
    EXPECT_TRUE(isOneLineWith(layered, "is a layered character")) << layered.output;
  }
}

}  // namespace
}  // namespace fourdvt::test
