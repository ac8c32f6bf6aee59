// SPDX-License-Identifier: Apache-2.0
// Mattes in the alpha channel of the colour pictures: stills, and simulated videos.
#include "capture/matted_pictures.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

constexpr int kWidth = SmallCapture::kWidth, kHeight = SmallCapture::kHeight;

// Grey 90, with a box that is opaque in `alpha`; the rest is transparent.
Image cutOut(int left = 4) {
  Image out(kWidth, kHeight, 4, 90);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) out.at(x, y)[3] = x >= left && x < left + 6 && y > 2 && y < 10 ? 255 : 0;
  return out;
}

Image constantAlpha(uint8_t alpha) {
  Image out(kWidth, kHeight, 4, 90);
  for (size_t i = 3; i < out.pixels.size(); i += 4) out.pixels[i] = alpha;
  return out;
}

class CutOuts : public SmallCapture {
 public:
  CutOuts() {
    remove("walk/mask00");
    remove("walk/mask01");
    for (int frame = 0; frame < kFrames; ++frame)
      for (const char* camera : {"walk/cam00/", "walk/cam01/"}) write(camera + numbered(frame, ".png"), cutOut());
  }
  MatteOrigin origin() const {
    const auto capture = openDescription(path(), {}, MeshNeed::Nothing).take();
    return matteOrigin(capture.sequences[0], capture.cameras[0], platform::openVideoFile).take();
  }
};

TEST(MattedPictures, AlphaOfColourIsTheMatte) {
  const CutOuts files;
  files.write("background/cam00.png", SmallCapture::grey(90));  // plates have lower priority
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader =
      mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile).take();
  const auto frame = reader->next();
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  for (const Image& picture : frame.value().pictures) EXPECT_EQ(picture.pixels, cutOut().pixels);
}

TEST(MattedPictures, AlphaIsNotReadWhereColourAloneIsRequired) {
  const CutOuts files;
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile, 0,
                                          MatteNeed::None)
                    .take();
  EXPECT_EQ(reader->next().value().pictures[0].at(0, 0)[3], 255);
}

TEST(MattedPictures, FilesComeBeforeAlpha) {
  const CutOuts files;
  for (int frame = 0; frame < 3; ++frame)
    files.write("walk/mask00/" + numbered(frame, ".png"), framedMatte(kWidth, kHeight));
  EXPECT_EQ(files.origin(), MatteOrigin::Files);
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader =
      mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile).take();
  EXPECT_EQ(reader->next().value().pictures[0].at(1, 1)[3], 255);
}

TEST(MattedPictures, ConstantAlphaIsNoMatte) {
  for (const uint8_t alpha : {uint8_t(255), uint8_t(0), uint8_t(77)}) {
    const CutOuts files;
    for (int frame = 0; frame < 3; ++frame) files.write("walk/cam00/" + numbered(frame, ".png"), constantAlpha(alpha));
    EXPECT_EQ(files.origin(), MatteOrigin::None);
    expectError(files.open(), ErrorId::FileMissing, files / "background/cam00.png");
    files.write("walk/cam00/000002.png", cutOut());  // the performer appears later
    EXPECT_EQ(files.origin(), MatteOrigin::ColourAlpha);
  }
}

TEST(MattedPictures, AlphaThatIsInvertedIsNamed) {
  const CutOuts files;
  Image inverted = cutOut();
  for (size_t i = 3; i < inverted.pixels.size(); i += 4) inverted.pixels[i] = uint8_t(255 - inverted.pixels[i]);
  for (int frame = 0; frame < 3; ++frame) files.write("walk/cam01/" + numbered(frame, ".png"), inverted);
  expectError(files.open(), ErrorId::FileUnreadable, files / "walk/cam01/000000.png (alpha)");
}

TEST(MattedPictures, SixteenBitsAreRead) {
  const CutOuts files;
  cv::Mat wide(kHeight, kWidth, CV_16UC4, cv::Scalar(30 * 257, 20 * 257, 10 * 257, 0));
  wide(cv::Rect(4, 3, 6, 7)).setTo(cv::Scalar(30 * 257, 20 * 257, 10 * 257, 65535));
  ASSERT_TRUE(cv::imwrite(files / "walk/cam00/000000.png", wide));
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader =
      mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile).take();
  const Image picture = reader->next().value().pictures[0];
  EXPECT_EQ(std::vector<uint8_t>(picture.at(5, 5), picture.at(5, 5) + 4), (std::vector<uint8_t>{10, 20, 30, 255}));
  EXPECT_EQ(picture.at(0, 0)[3], 0);
}

// Mattes whose 8-bit values were written into 16 bits.
TEST(MattedPictures, SmallValuesIn16BitsAreRead) {
  const SmallCapture files;
  cv::Mat wide(kHeight, kWidth, CV_16U, cv::Scalar(0));
  wide(cv::Rect(4, 3, 6, 7)).setTo(cv::Scalar(255));
  for (const char* file : {"walk/mask00/000000.png", "walk/mask00/000001.png", "walk/mask00/000002.png"})
    ASSERT_TRUE(cv::imwrite(files / file, wide));
  EXPECT_EQ(*readPicture(files / "walk/mask00/000000.png", 1).value().at(5, 5), 255);
  wide.setTo(cv::Scalar(1), wide > 0);
  for (const char* file : {"walk/mask00/000000.png", "walk/mask00/000001.png", "walk/mask00/000002.png"})
    ASSERT_TRUE(cv::imwrite(files / file, wide));
  expectError(files.open(), ErrorId::FileUnreadable, files / "walk/mask00");
}

// A video that counts how it was opened.
struct AlphaVideo final : VideoSource {
  explicit AlphaVideo(int wanted) : channels(wanted) {}
  Result<std::optional<Image>> next() override {
    if (channels == 4) return std::optional<Image>(cutOut());
    return std::optional<Image>(Image(kWidth, kHeight, channels, 90));
  }
  bool hasAlpha() const override { return true; }
  int channels;
};

TEST(MattedPictures, AlphaOfVideosIsTheMatte) {
  const CutOuts files;
  files.write("walk/cam00.webm", std::string("x"));
  const OpenVideo video = [](const std::string&, int channels) -> Result<std::unique_ptr<VideoSource>> {
    return std::unique_ptr<VideoSource>(std::make_unique<AlphaVideo>(channels));
  };
  const auto capture = mattes::openCapture(files.path(), video);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], video).take();
  EXPECT_EQ(reader->next().value().pictures[0].pixels, cutOut().pixels);
}

TEST(MattedPictures, AlphaThatDoesNotDecodeIsAnError) {
  const CutOuts files;
  files.write("walk/cam00.mov", std::string("x"));
  const OpenVideo video = [](const std::string& path, int channels) -> Result<std::unique_ptr<VideoSource>> {
    if (channels != 3) return Error{ErrorId::FileUnreadable, path + ": alpha is not decoded; export it again"};
    return std::unique_ptr<VideoSource>(std::make_unique<AlphaVideo>(channels));
  };
  expectError(mattes::openCapture(files.path(), video), ErrorId::FileUnreadable, files / "walk/cam00.mov");
  EXPECT_TRUE(mattes::openCapture(files.path(), video, {}, MeshNeed::ConstantTopology, MatteNeed::None).ok());
}

}  // namespace
}  // namespace fourdvt::capture
