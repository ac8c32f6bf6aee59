// SPDX-License-Identifier: Apache-2.0
// The options of a bake and the table of named settings: a bake accepts every entry, entries are in order, and the
// default entry equals the options' defaults.
#include "bake/quality.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fourdvt::bake {
namespace {

BakeOptions named() {
  BakeOptions options;
  options.capture_folder = "capture";
  options.character_folder = "character";
  return options;
}

TEST(Quality, EveryEntryIsAcceptedForEveryCodec) {
  for (const Quality& quality : qualities()) {
    for (const encode::Codec codec : {encode::Codec::H264, encode::Codec::Vp9, encode::Codec::Av1}) {
      BakeOptions options = named();
      applyQuality(quality, codec, options);
      EXPECT_EQ(options.check(), "") << quality.name << " " << encode::infoOf(codec).name;
      EXPECT_EQ(options.codec, codec);
      EXPECT_TRUE(encode::knowsPreset(codec, options.preset)) << quality.name << " " << encode::infoOf(codec).name;
      EXPECT_LE(options.crf, encode::infoOf(codec).highest_crf);
      EXPECT_EQ(findQuality(quality.name), &quality);
    }
  }
  EXPECT_EQ(findQuality("best"), nullptr);
  EXPECT_EQ(findQuality(""), nullptr);
}

TEST(Quality, HigherMeansMoreTexelsOrFinerQuantisation) {
  for (size_t i = 1; i < qualities().size(); ++i) {
    const Quality &low = qualities()[i - 1], &high = qualities()[i];
    EXPECT_GE(high.texture, low.texture);
    EXPECT_GE(high.layers, low.layers);
    for (int codec = 0; codec < 3; ++codec) {
      const bool finer = high.crf[codec] < low.crf[codec];
      EXPECT_TRUE(finer || high.texture > low.texture || high.layers > low.layers) << high.name << " " << codec;
    }
  }
}

TEST(Quality, LeavesTheRestAlone) {
  BakeOptions options = named();
  options.gop = 7;
  options.equal_layers = true;
  const Labelling other{"other", false, nullptr};
  options.labels = &other;
  applyQuality(*findQuality("draft"), encode::Codec::Vp9, options);
  EXPECT_EQ(options.gop, 7);
  EXPECT_TRUE(options.equal_layers);
  EXPECT_EQ(options.labels, &other);
  EXPECT_EQ(options.capture_folder, "capture");
}

// The library and the command line bake the same by default.
TEST(Quality, DefaultIsThatOfBakeOptions) {
  const BakeOptions defaults;
  BakeOptions options;
  ASSERT_NE(findQuality(kDefaultQuality), nullptr);
  applyQuality(*findQuality(kDefaultQuality), defaults.codec, options);
  EXPECT_EQ(options.texture, defaults.texture);
  EXPECT_EQ(options.layers, defaults.layers);
  EXPECT_EQ(options.crf, defaults.crf);
  EXPECT_EQ(options.preset, defaults.preset.empty() ? encode::infoOf(defaults.codec).default_preset : defaults.preset);
}

TEST(BakeOptions, CheckNamesWhatIsWrong) {
  const BakeOptions good = named();
  EXPECT_EQ(good.check(), "");
  const auto wrong = [&](auto change) {
    BakeOptions options = good;
    change(options);
    return options.check();
  };
  EXPECT_NE(wrong([](BakeOptions& o) { o.layers = 7; }).find("layers"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.texture = 1000; }).find("texture"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.texture = 4096; }).find("smaller texture"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.crf = 52; }).find("crf"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.gop = 0; }).find("gop"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.jobs = -1; }).find("jobs"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.position_step_m = std::nan(""); }).find("step"), std::string::npos);
  EXPECT_NE(wrong([](BakeOptions& o) { o.character_folder = ""; }).find("-o"), std::string::npos);
}

}  // namespace
}  // namespace fourdvt::bake
