// SPDX-License-Identifier: Apache-2.0
#include "store/record_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace fourdvt::store {
namespace {

namespace fs = std::filesystem;

struct RecordFileTest : testing::Test {
  fs::path folder = fs::path(testing::TempDir()) / ("record_file_test_" + std::to_string(getpid()));
  std::string path = (folder / "a.bin").string();
  void SetUp() override {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  static std::vector<uint8_t> record(uint8_t value) { return std::vector<uint8_t>(5, value); }
};

TEST_F(RecordFileTest, IsThereOnlyOnceItIsComplete) {
  auto file = RecordFile::resume(path, 5, 2);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file.value().append(record(1)).ok());
  EXPECT_FALSE(file.value().finish().ok()) << "a record is missing";
  EXPECT_FALSE(RecordFile::isComplete(path, 5, 2));
  ASSERT_TRUE(file.value().append(record(2)).ok());
  EXPECT_FALSE(file.value().append(record(3)).ok()) << "too many";
  ASSERT_TRUE(file.value().finish().ok());
  EXPECT_TRUE(RecordFile::isComplete(path, 5, 2));
  EXPECT_FALSE(fs::exists(path + ".part"));
  EXPECT_EQ(RecordFile::readOne(path, 5, 1).value(), record(2));
  EXPECT_FALSE(RecordFile::readOne(path, 5, 2));
  EXPECT_FALSE(RecordFile::isComplete(path, 5, 3)) << "of another length";
}

TEST_F(RecordFileTest, GoesOnAfterTheLastWholeRecord) {
  {
    auto file = RecordFile::resume(path, 5, 3);
    ASSERT_TRUE(file.value().append(record(1)).ok());
  }
  std::ofstream(path + ".part", std::ios::app | std::ios::binary) << "ab";  // torn by a crash
  auto file = RecordFile::resume(path, 5, 3);
  ASSERT_TRUE(file);
  EXPECT_EQ(file.value().count(), 1u);
  ASSERT_TRUE(file.value().append(record(2)).ok());
  EXPECT_EQ(file.value().read(0).value(), record(1));
  EXPECT_EQ(file.value().read(1).value(), record(2));
  ASSERT_TRUE(file.value().append(record(3)).ok());
  ASSERT_TRUE(file.value().finish().ok());
  EXPECT_EQ(file.value().read(2).value(), record(3)) << "still readable once it is in place";
}

// A process that starts anew does not remove a file that another one has completed meanwhile.
TEST_F(RecordFileTest, AnewLeavesACompleteFileUntilItIsReplaced) {
  auto late = RecordFile::begin(path, 5, 1, ".late");
  auto first = RecordFile::begin(path, 5, 1, ".first");
  ASSERT_TRUE(first.value().append(record(1)).ok());
  ASSERT_TRUE(first.value().finish().ok());
  auto later = RecordFile::begin(path, 5, 1, ".later");
  EXPECT_EQ(RecordFile::readOne(path, 5, 0).value(), record(1));
  EXPECT_EQ(later.value().count(), 0u);
  ASSERT_TRUE(late.value().append(record(2)).ok());
  ASSERT_TRUE(late.value().finish().ok());
  EXPECT_EQ(RecordFile::readOne(path, 5, 0).value(), record(2));
}

TEST_F(RecordFileTest, RefusesRecordsOfAnotherSize) {
  auto file = RecordFile::resume(path, 5, 1);
  EXPECT_FALSE(file.value().append(std::vector<uint8_t>(4)).ok());
}

TEST_F(RecordFileTest, FolderThatIsNotThereIsAWriteError) {
  auto file = RecordFile::resume((folder / "no/b.bin").string(), 5, 1);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().id, ErrorId::WriteFailed);
  EXPECT_NE(file.error().message.find("no/b.bin"), std::string::npos);
}

}  // namespace
}  // namespace fourdvt::store
