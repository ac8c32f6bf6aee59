// SPDX-License-Identifier: Apache-2.0
#include "bake/run/survey_files.h"

#include <gtest/gtest.h>

namespace fourdvt::bake {
namespace {

TEST(SurveyFiles, StatisticsRoundTripAndRefuseOtherLengths) {
  LabelStatistics in;
  in.frames = 7;
  in.seam_percent = {1, 2, 3};
  in.flip_percent = {4};
  in.camera_flip_percent = {0.5, 0.25};
  in.seen_seam_percent = {7, 8};
  in.seen_flip_percent = {9};
  in.mean_penalty = {0.125, 1};
  in.energy = 12345.5;
  in.seconds = 2;
  std::vector<uint8_t> bytes = statisticsBytes(in);
  LabelStatistics out;
  ASSERT_TRUE(statisticsFrom(bytes, out));
  EXPECT_EQ(out.frames, 7u);
  EXPECT_EQ(out.seam_percent, in.seam_percent);
  EXPECT_EQ(out.flip_percent, in.flip_percent);
  EXPECT_EQ(out.camera_seam_percent, in.camera_seam_percent);
  EXPECT_EQ(out.camera_flip_percent, in.camera_flip_percent);
  EXPECT_EQ(out.seen_seam_percent, in.seen_seam_percent);
  EXPECT_EQ(out.seen_flip_percent, in.seen_flip_percent);
  EXPECT_EQ(out.mean_penalty, in.mean_penalty);
  EXPECT_EQ(out.energy, in.energy);
  EXPECT_EQ(out.seconds, in.seconds);
  for (size_t n = 0; n < bytes.size(); ++n) {
    LabelStatistics part;
    EXPECT_FALSE(statisticsFrom(std::span(bytes).first(n), part)) << n;
  }
  bytes.push_back(0);
  EXPECT_FALSE(statisticsFrom(bytes, out));
}

TEST(SurveyFiles, ColourMapsRoundTrip) {
  std::vector<ColourMap> in(2), out(2), three(3);
  in[1].matrix = glm::mat3(1, 2, 3, 4, 5, 6, 7, 8, 9);
  in[1].offset = {0.5f, -0.25f, 0.125f};
  const std::vector<uint8_t> bytes = coloursBytes(in);
  ASSERT_TRUE(coloursFrom(bytes, out));
  EXPECT_EQ(out[1].matrix, in[1].matrix);
  EXPECT_EQ(out[1].offset, in[1].offset);
  EXPECT_EQ(out[0].matrix, glm::mat3(1));
  EXPECT_FALSE(coloursFrom(bytes, three)) << "another number of cameras";
}

TEST(SurveyFiles, PathsDifferByKey) {
  EXPECT_NE(keyedPath("f", "a", "1"), keyedPath("f", "a", "2"));
  EXPECT_EQ(keyedPath("f", "a", "1").rfind("f/a_", 0), 0u);
  const std::string long_name(300, 'x');
  EXPECT_NE(keyedPath("f", long_name, "1"), keyedPath("f", long_name, "2"));
}

}  // namespace
}  // namespace fourdvt::bake
