// SPDX-License-Identifier: Apache-2.0
#include "platform/files.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

namespace fourdvt::platform {
namespace {

namespace fs = std::filesystem;

class PlatformFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("fourdvt_files_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  size_t entries() const { return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), {})); }
  fs::path folder_;
};

std::vector<uint8_t> counting(size_t size) {
  std::vector<uint8_t> bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(i);
  return bytes;
}

TEST_F(PlatformFiles, WholeFilesAndRanges) {
  ASSERT_TRUE(writeFileAtomic(path("a.bin"), counting(300)).ok());
  EXPECT_EQ(readFile(path("a.bin")).value(), counting(300));
  const auto range = readFileRange(path("a.bin"), 10, 4);
  ASSERT_TRUE(range.ok());
  EXPECT_EQ(range.value(), (std::vector<uint8_t>{10, 11, 12, 13}));
  EXPECT_TRUE(readFileRange(path("a.bin"), 300, 0).ok());
  EXPECT_EQ(readFileRange(path("a.bin"), 298, 3).error().id, ErrorId::FileUnreadable);
  EXPECT_EQ(readFileRange(path("a.bin"), ~0ull, 3).error().id, ErrorId::FileUnreadable);
  EXPECT_EQ(readFile(path("none")).error().id, ErrorId::FileMissing);
  EXPECT_NE(readFile(path("none")).error().message.find(path("none")), std::string::npos);
  EXPECT_EQ(readFile(folder_.string()).error().id, ErrorId::FileUnreadable);
}

TEST_F(PlatformFiles, AtomicWriteReplacesAndLeavesNothingElse) {
  ASSERT_TRUE(writeFileAtomic(path("a.bin"), counting(10)).ok());
  ASSERT_TRUE(writeFileAtomic(path("a.bin"), counting(20)).ok());
  EXPECT_EQ(readFile(path("a.bin")).value().size(), 20u);
  EXPECT_EQ(entries(), 1u);
  EXPECT_EQ(writeFileAtomic(path("no/such/folder.bin"), counting(1)).error().id, ErrorId::WriteFailed);
  EXPECT_EQ(writeFileAtomic(path("a.bin/below.bin"), counting(1)).error().id, ErrorId::WriteFailed);
}

// A file size limit simulates a full disk: the old file stays complete.
TEST_F(PlatformFiles, FailedWriteKeepsTheOldFile) {
  ASSERT_TRUE(writeFileAtomic(path("a.bin"), counting(10)).ok());
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight{1000, before.rlim_max};
  auto* handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &tight);
  const Status status = writeFileAtomic(path("a.bin"), counting(5000));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().id, ErrorId::WriteFailed);
  EXPECT_EQ(readFile(path("a.bin")).value(), counting(10));
  EXPECT_EQ(entries(), 1u);
}

TEST_F(PlatformFiles, JsonBecomesAFlatTable) {
  const std::string text = R"({"a": [1, {"b": "x"}, true, null, []], "c/d~e": -2.5e1})";
  ASSERT_TRUE(writeFileAtomic(path("a.json"), {reinterpret_cast<const uint8_t*>(text.data()), text.size()}).ok());
  const auto flat = readJsonFlat(path("a.json"));
  ASSERT_TRUE(flat.ok());
  EXPECT_EQ(flat.value().number("/a/0"), 1.0);
  EXPECT_EQ(flat.value().string("/a/1/b"), "x");
  EXPECT_EQ(flat.value().boolean("/a/2"), true);
  EXPECT_FALSE(flat.value().has("/a/3"));
  EXPECT_EQ(flat.value().number("/c~1d~0e"), -25.0);
  EXPECT_EQ(flat.value().size(), 4u);
  for (const std::string bad : {"", "{", "{\"a\": 1", "{} x", "\xff"}) {
    ASSERT_TRUE(writeFileAtomic(path("b.json"), {reinterpret_cast<const uint8_t*>(bad.data()), bad.size()}).ok());
    EXPECT_EQ(readJsonFlat(path("b.json")).error().id, ErrorId::ManifestInvalid) << bad;
  }
  EXPECT_EQ(readJsonFlat(path("none.json")).error().id, ErrorId::FileMissing);
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  ASSERT_TRUE(writeFileAtomic(path("c.json"), {reinterpret_cast<const uint8_t*>(deep.data()), deep.size()}).ok());
  EXPECT_EQ(readJsonFlat(path("c.json")).error().id, ErrorId::ManifestInvalid);
}

Image gradient(int channels) {
  Image image(24, 16, channels);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      for (int c = 0; c < channels; ++c)
        image.at(x, y)[c] = static_cast<uint8_t>(c == 3 ? 255 - x : 40 * c + 4 * x + y);
    }
  }
  return image;
}

TEST_F(PlatformFiles, PicturesKeepTheirChannels) {
  for (int channels : {3, 4}) {
    const Image image = gradient(channels);
    ASSERT_TRUE(writeImage(path("a.png"), image).ok());
    const auto read = readImage(path("a.png"));
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read.value().channels, channels);
    EXPECT_EQ(read.value().pixels, image.pixels);
    for (const char* name : {"a.webp", "a.jpg"}) {
      if (channels == 4 && std::string(name) == "a.jpg") continue;
      ASSERT_TRUE(writeImage(path(name), image, 95).ok());
      const auto lossy = readImage(path(name));
      ASSERT_TRUE(lossy.ok());
      ASSERT_EQ(lossy.value().width, 24);
      EXPECT_NEAR(lossy.value().at(12, 8)[0], image.at(12, 8)[0], 12);
      EXPECT_NEAR(lossy.value().at(12, 8)[2], image.at(12, 8)[2], 12);
    }
  }
}

TEST_F(PlatformFiles, BadPicturesAreErrors) {
  ASSERT_TRUE(writeFileAtomic(path("a.png"), counting(100)).ok());
  EXPECT_EQ(readImage(path("a.png")).error().id, ErrorId::FileUnreadable);
  EXPECT_EQ(readImage(path("none.png")).error().id, ErrorId::FileMissing);
  EXPECT_EQ(writeImage(path("a"), gradient(3)).error().id, ErrorId::WriteFailed);
  EXPECT_EQ(writeImage(path("a.xyz"), gradient(3)).error().id, ErrorId::WriteFailed);
  EXPECT_EQ(writeImage(path("a.png"), Image()).error().id, ErrorId::InvalidArgument);
}

}  // namespace
}  // namespace fourdvt::platform
