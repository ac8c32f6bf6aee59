// SPDX-License-Identifier: Apache-2.0
// Captures without mattes: the key chosen for their plates, its override in capture.json, and errors in plates and
// mattes.
#include "capture/matte_flaw.h"
#include "capture_fixture.h"
#include "mattes/background_key.h"
#include "mattes/background_model.h"
#include "mattes/plate_key.h"

namespace fourdvt::mattes {

using namespace capture;

namespace {

constexpr int kWidth = 96, kHeight = 72;

uint8_t grain(int x, int y, int c) { return static_cast<uint8_t>((x * 37 + y * 91 + c * 53 + x * y * 7) % 23); }

Image woodPlate() {
  Image out(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y)[c] = static_cast<uint8_t>(110 - 20 * c + (x / 12 % 3) * 18 + grain(x, y, c) / 2);
  return out;
}

Image greenPlate() {
  Image out(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y)[c] = static_cast<uint8_t>((c == 1 ? 165 : 50 + 20 * c) + grain(x, y, 1) / 4);
  return out;
}

// Adds a blue box in the foreground.
Image withObject(Image plate) {
  for (int y = 20; y < 60; ++y)
    for (int x = 30; x < 60; ++x) plate.at(x, y)[0] = 40, plate.at(x, y)[1] = 60, plate.at(x, y)[2] = 180;
  return plate;
}

Image fitted(const Image& picture, const std::vector<Image>& plates) {
  return backgroundKey(picture, fitPlate(makeBackgroundModel(plates), picture).background);
}

// cam00 stands in front of wood, cam01 in front of green; neither has mattes.
class PlateCapture : public SmallCapture {
 public:
  PlateCapture() {
    write("cameras/cameras.txt", std::string("1 PINHOLE 96 72 100 100 48 36\n"));
    for (const char* name : {"walk/mask00", "walk/mask01"}) remove(name);
    for (int frame = 0; frame < kFrames; ++frame) {
      write("walk/cam00/" + numbered(frame, ".png"), withObject(woodPlate()));
      write("walk/cam01/" + numbered(frame, ".png"), withObject(greenPlate()));
    }
    write("background/cam00.png", woodPlate());
    write("background/cam01.png", greenPlate());
  }
  void declare(const std::string& background) const {
    const std::string text = json();
    write("capture.json", text.substr(0, text.size() - 1) + ", \"background\": " + background + "}");
  }
  void setMattes(const std::string& stem, const Image& matte) const {
    for (int frame = 0; frame < kFrames; ++frame) write(stem + "/" + numbered(frame, ".png"), matte);
  }
  // Mattes of the first frame; empty if the capture does not open.
  std::vector<Image> mattes() const {
    auto capture = open();
    EXPECT_TRUE(capture) << capture.error().message;
    if (!capture) return std::vector<Image>(2);
    auto reader = FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile);
    auto frame = reader.value()->next();
    EXPECT_TRUE(frame) << frame.error().message;
    std::vector<Image> out;
    for (const Image& picture : frame.value().pictures) {
      out.emplace_back(picture.width, picture.height, 1);
      for (size_t i = 0; i < out.back().pixels.size(); ++i) out.back().pixels[i] = picture.pixels[4 * i + 3];
    }
    return out;
  }
};

TEST(CapturePlates, EveryCameraGetsTheKeyOfItsPlate) {
  PlateCapture files;
  const std::vector<Image> got = files.mattes();
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].pixels, backgroundKey(withObject(woodPlate()), makeBackgroundModel(std::array{woodPlate()})).pixels);
  EXPECT_EQ(got[1].pixels, chromaKey(withObject(greenPlate()), greenPlate()).pixels);
  for (const Image& matte : got) {
    EXPECT_EQ(*matte.at(45, 40), 255);
    EXPECT_EQ(*matte.at(10, 10), 0);
  }
}

TEST(CapturePlates, CaptureJsonOverridesTheKind) {
  PlateCapture files;
  files.declare(R"({"plates": "background/camNN.png", "kind": "chroma"})");
  EXPECT_EQ(files.mattes()[0].pixels, chromaKey(withObject(woodPlate()), woodPlate()).pixels);
  files.declare(R"({"kind": "natural"})");
  EXPECT_EQ(files.mattes()[1].pixels,
            backgroundKey(withObject(greenPlate()), makeBackgroundModel(std::array{greenPlate()})).pixels);
  for (const char* wrong : {R"({"kind": "green"})", R"({"kind": 1})", R"({"plates": 1})", "7", "[]"}) {
    SCOPED_TRACE(wrong);
    files.declare(wrong);
    expectError(files.open(), ErrorId::CaptureJson, "background");
  }
}

TEST(CapturePlates, SeveralPlatesLieInAFolder) {
  PlateCapture files;
  std::vector<Image> plates{woodPlate(), woodPlate(), woodPlate()};
  for (size_t k = 0; k < plates.size(); ++k) {
    for (size_t i = k; i < plates[k].pixels.size(); i += 7) plates[k].pixels[i] += 6;
    files.write("plates/cam00/" + numbered(int(k), ".png"), plates[k]);
  }
  files.write("plates/cam01.png", greenPlate());
  for (const char* form :
       {"\"plates/camNN/%06d.png\"", "\"plates/camNN.png\"", R"({"plates": "plates/camNN/%06d.png"})"}) {
    files.declare(form);
    EXPECT_EQ(files.mattes()[0].pixels, fitted(withObject(woodPlate()), plates).pixels);
  }
  files.write("plates/cam00/000001.png", Image(kWidth, kHeight + 2, 3));
  expectError(files.open(), ErrorId::FrameSize, files / "plates/cam00/000001.png");
}

TEST(CapturePlates, MissingOrOfAnotherSize) {
  PlateCapture files;
  files.remove("background/cam00.png");
  expectError(files.open(), ErrorId::FileMissing, files / "background/cam00.png");
  files.write("background/cam00.png", Image(kWidth + 2, kHeight, 3));
  expectError(files.open(), ErrorId::FrameSize, files / "background/cam00.png");
  files.write("background/cam00.png", std::string("no picture"));
  expectError(files.open(), ErrorId::FileUnreadable, files / "background/cam00.png");
}

// Plates of another room, or with the light off.
TEST(CapturePlates, PlateThatDoesNotFit) {
  PlateCapture files;
  Image other = woodPlate();
  for (uint8_t& v : other.pixels) v = static_cast<uint8_t>(255 - v);
  files.write("background/cam00.png", other);
  expectError(files.open(), ErrorId::FileUnreadable, files / "background/cam00.png");
}

TEST(CapturePlates, NobodyInThePictureIsNoError) {
  PlateCapture files;
  for (int frame = 0; frame < 3; ++frame) files.write("walk/cam00/" + numbered(frame, ".png"), woodPlate());
  files.setMattes("walk/mask01", Image(kWidth, kHeight, 1));
  for (const Image& matte : files.mattes()) EXPECT_EQ(matte.pixels, std::vector<uint8_t>(matte.pixels.size(), 0));
}

Image invertedMatte() {
  Image out(kWidth, kHeight, 1, 255);
  for (int y = 20; y < kHeight; ++y)  // removes the object's feet
    for (int x = 30; x < 60; ++x) *out.at(x, y) = 0;
  return out;
}

TEST(CapturePlates, InvertedMattesAreNamed) {
  PlateCapture files;
  files.setMattes("walk/mask01", invertedMatte());
  const auto images = files.open();
  expectError(images, ErrorId::FileUnreadable, files / "walk/mask01");
  EXPECT_NE(images.error().message.find("invert the mattes"), std::string::npos) << images.error().message;
}

TEST(CapturePlates, InvertedMatteVideosAreNamed) {
  struct Matte final : VideoSource {
    Result<std::optional<Image>> next() override { return std::optional<Image>(invertedMatte()); }
  };
  PlateCapture files;
  files.write("walk/mask00.mkv", std::string("x"));
  const OpenVideo video = [](const std::string&, int) -> Result<std::unique_ptr<VideoSource>> {
    return std::unique_ptr<VideoSource>(std::make_unique<Matte>());
  };
  expectError(openCapture(files.path(), video), ErrorId::FileUnreadable, files / "walk/mask00.mkv");
}

// Matte of an object that fills the picture except its upper corners.
Image closeUp() {
  Image out(kWidth, kHeight, 1, 255);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (x < 25 || x > 70) *out.at(x, y) = 0;
  return out;
}

// Label picture of two values.
Image labels(uint8_t object) {
  Image out(kWidth, kHeight, 1);
  for (int y = 20; y < 60; ++y)
    for (int x = 30; x < 60; ++x) *out.at(x, y) = object;
  return out;
}

TEST(MatteFlaw, IsOfMattesThatCannotBeMeant) {
  EXPECT_EQ(flawOf(invertedMatte()), MatteFlaw::Swapped);
  Image upright = invertedMatte();
  for (uint8_t& a : upright.pixels) a = static_cast<uint8_t>(255 - a);
  EXPECT_EQ(flawOf(upright), MatteFlaw::None);
  EXPECT_EQ(flawOf(closeUp()), MatteFlaw::None);
  EXPECT_EQ(flawOf(Image(kWidth, kHeight, 1, 255)), MatteFlaw::Covered);
  Image specks(kWidth, kHeight, 1, 255);
  *specks.at(5, 5) = *specks.at(50, 7) = 0;
  EXPECT_EQ(flawOf(specks), MatteFlaw::Covered);
  EXPECT_EQ(flawOf(Image(kWidth, kHeight, 1, 0)), MatteFlaw::None);
  EXPECT_EQ(flawOf(labels(1)), MatteFlaw::Labels);
  EXPECT_EQ(flawOf(labels(38)), MatteFlaw::Labels);  // first colour of a usual label palette
  EXPECT_EQ(flawOf(labels(128)), MatteFlaw::None);
  Image noise(kWidth, kHeight, 1, 0);  // compression noise of an empty matte
  *noise.at(4, 4) = *noise.at(9, 3) = 1;
  EXPECT_EQ(flawOf(noise), MatteFlaw::None);
  Image ramp(kWidth, kHeight, 1, 0);
  for (int x = 0; x < kWidth; ++x) *ramp.at(x, 30) = uint8_t(x);
  EXPECT_EQ(flawOf(ramp), MatteFlaw::None);
}

TEST(CapturePlates, MattesThatCannotBeMeantAreNamed) {
  for (const auto& [matte, words] : {std::pair{Image(kWidth, kHeight, 1, 255), "covers the whole picture"},
                                     {labels(1), "write 255 for the object"}}) {
    PlateCapture files;
    files.setMattes("walk/mask01", matte);
    const auto opened = files.open();
    expectError(opened, ErrorId::FileUnreadable, files / "walk/mask01");
    EXPECT_NE(opened.error().message.find(words), std::string::npos) << opened.error().message;
    EXPECT_NE(opened.error().message.find("--leave-out cam01"), std::string::npos) << opened.error().message;
  }
}

TEST(CapturePlates, OneFrameThatIsFilledIsNoError) {
  PlateCapture files;
  files.setMattes("walk/mask01", Image(kWidth, kHeight, 1, 255));
  files.write("walk/mask01/000002.png", closeUp());
  EXPECT_TRUE(files.open().ok()) << files.open().error().message;
  files.write("walk/mask01/000002.png", Image(kWidth, kHeight, 1, 0));
  expectError(files.open(), ErrorId::FileUnreadable, files / "walk/mask01");
}

// Checks the first non-empty frame.
TEST(CapturePlates, EmptyMattesAreNotJudged) {
  PlateCapture files;
  files.setMattes("walk/mask01", Image(kWidth, kHeight, 1, 0));
  files.write("walk/mask01/000001.png", labels(1));
  const auto opened = files.open();
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  auto reader = FrameReader::open(opened.value(), opened.value().sequences[0], platform::openVideoFile).take();
  EXPECT_TRUE(reader->next().ok());
  expectError(reader->next(), ErrorId::FileUnreadable, files / "walk/mask01");
}

}  // namespace
}  // namespace fourdvt::mattes
