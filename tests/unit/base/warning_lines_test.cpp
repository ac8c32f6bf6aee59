// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "base/text.h"

namespace fourdvt {
namespace {

using Lines = std::vector<std::string>;

TEST(WarningLines, OfSeveralSubjectsAreOne) {
  EXPECT_EQ(
      joinedWarnings({"in/cam00.mp4: 30 frames a second; give --fps", "other: once",
                      "in/cam01.mp4: 30 frames a second; give --fps", "in/cam02.mp4: 30 frames a second; give --fps"}),
      (Lines{"in/cam00.mp4, cam01.mp4, cam02.mp4: 30 frames a second; give --fps", "other: once"}));
}

TEST(WarningLines, NameWhatDiffersInFull) {
  EXPECT_EQ(joinedWarnings({"a/x/1.png: bad", "a/y/1.png: bad", "b/2.png: bad", "b/2.png: bad"}),
            (Lines{"a/x/1.png, y/1.png, b/2.png: bad"}));
  EXPECT_EQ(joinedWarnings({"walk, camera \"cam00\" (81 %): look", "walk, camera \"cam01\" (82 %): look",
                            "run, camera \"cam01\" (82 %): look"}),
            (Lines{"walk, camera \"cam00\" (81 %), \"cam01\" (82 %), run, camera \"cam01\" (82 %): look"}));
}

TEST(WarningLines, NameCamerasOnce) {
  EXPECT_EQ(joinedWarnings({"camera cam1: none", "camera cam2: none", "camera cam3: none"}),
            (Lines{"cameras cam1, cam2, cam3: none"}));
  EXPECT_EQ(joinedWarnings({"a: none", "b: none", "a: none", "b: none"}), (Lines{"a, b: none"})) << "of two takes";
}

TEST(WarningLines, ThatDifferStay) {
  const Lines lines{"cam00: 30 frames", "cam01: 25 frames", "no subject", "no subject", ": nothing", ""};
  EXPECT_EQ(joinedWarnings(lines), lines);
}

}  // namespace
}  // namespace fourdvt
