// SPDX-License-Identifier: Apache-2.0
// The table of named settings: every entry is one that a bake accepts, in order, and the default is the default.
#include "bake/quality.h"

#include <gtest/gtest.h>

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
    for (const Codec codec : {Codec::H264, Codec::Vp9, Codec::Av1}) {
      BakeOptions options = named();
      applyQuality(quality, codec, options);
      EXPECT_EQ(options.check(), "") << quality.name << " " << infoOf(codec).name;
      EXPECT_EQ(options.codec, codec);
      EXPECT_TRUE(knowsPreset(codec, options.preset)) << quality.name << " " << infoOf(codec).name;
      EXPECT_LE(options.crf, infoOf(codec).highest_crf);
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
  applyQuality(*findQuality("draft"), Codec::Vp9, options);
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
  EXPECT_EQ(options.preset, defaults.preset.empty() ? infoOf(defaults.codec).default_preset : defaults.preset);
}

}  // namespace
}  // namespace fourdvt::bake
