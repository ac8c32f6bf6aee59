// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "capture/import/views.h"

namespace fourdvt::capture {
namespace {

using Numbers = std::vector<int64_t>;

TEST(PictureNames, TheNumberThatDiffersCounts) {
  EXPECT_EQ(pictureNumbers({"shot_8", "shot_9", "shot_10"}), (Numbers{8, 9, 10}));
  EXPECT_EQ(pictureNumbers({"000003", "000007"}), (Numbers{3, 7}));
  EXPECT_EQ(pictureNumbers({"0001_cam7", "0002_cam7"}), (Numbers{1, 2})) << "not the last one";
  EXPECT_EQ(pictureNumbers({"cam1.9", "cam1.10"}), (Numbers{9, 10})) << "a version is no second";
  EXPECT_EQ(pictureNumbers({"cam1_0004"}), (Numbers{4})) << "of one picture the last one";
  EXPECT_EQ(pictureNumbers({"a1", "b", "b22"}), (Numbers{1, -1, 22})) << "names that are not alike";
}

TEST(PictureNames, SecondsHaveFractions) {
  const int64_t s = 1'000'000'000;
  EXPECT_EQ(pictureNumbers({"1700000000.88", "1700000000.96", "1700000001.00"}),
            (Numbers{1700000000 * s + 880'000'000, 1700000000 * s + 960'000'000, 1700000001 * s}));
  EXPECT_EQ(pictureNumbers({"1700000000.9", "1700000000.96"}),
            (Numbers{1700000000 * s + 900'000'000, 1700000000 * s + 960'000'000}))
      << "within one second, written without zeros at the end";
  EXPECT_EQ(pictureNumbers({"7.5", "8.25"}), (Numbers{7 * s + 500'000'000, 8 * s + 250'000'000}));
  EXPECT_EQ(pictureNumbers({"1700000000_880000000", "1700000001_000000000"}),
            (Numbers{1700000000 * s + 880'000'000, 1700000001 * s}));
  EXPECT_EQ(pictureNumbers({"1700000000880000000", "1700000001000000000"})[0] <
                pictureNumbers({"1700000000880000000", "1700000001000000000"})[1],
            true);
}

TEST(PictureNames, DatesAndTimesAreOrdered) {
  const Numbers numbers = pictureNumbers({"20240501_235959_960", "20240502_000000_000", "20240502_000000_040"});
  EXPECT_LT(numbers[0], numbers[1]);
  EXPECT_LT(numbers[1], numbers[2]);
}

TEST(PictureNames, AnyNameIsRead) {
  EXPECT_TRUE(pictureNumbers({}).empty());
  EXPECT_EQ(pictureNumbers({"", "x", "."}), (Numbers{-1, -1, -1}));
  const std::string digits(400, '9');
  EXPECT_EQ(pictureNumbers({digits, digits + "1"}).size(), 2u);
  for (const int64_t number : pictureNumbers({digits + "." + digits, "1." + digits, digits + ".1"}))
    EXPECT_GE(number, 0);
  for (const int64_t number : pictureNumbers({"9999999999.1", "9999999998.2"})) EXPECT_GE(number, 0);
}

}  // namespace
}  // namespace fourdvt::capture
