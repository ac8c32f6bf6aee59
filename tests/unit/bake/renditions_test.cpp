// SPDX-License-Identifier: Apache-2.0
// The ladder of renditions: parsing, the standard one, and invalid ones.
#include "bake/run/renditions.h"

#include <gtest/gtest.h>

#include "bake/quality.h"

namespace fourdvt::bake {
namespace {

BakeOptions named(encode::Codec codec = encode::Codec::H264) {
  BakeOptions options;
  options.capture_folder = "capture";
  options.character_folder = "character";
  applyQuality(*findQuality(kDefaultQuality), codec, options);
  options.appearance = package::AppearanceKind::Layers;
  return options;
}

std::string text(const std::vector<LowerRendition>& all) {
  std::string out;
  for (const LowerRendition& r : all) out += fileSuffix(r, named());
  return out;
}

std::string wrongWith(const std::vector<std::string>& entries, BakeOptions options = named()) {
  const std::string unread = parseRenditions(entries, options, options.lower_renditions);
  return unread.empty() ? options.check() : unread;
}

struct Bad {
  std::vector<std::string> entries;
  std::string part;
};

void expectBad(const std::vector<Bad>& all, const BakeOptions& options = named()) {
  for (const Bad& bad : all)
    EXPECT_NE(wrongWith(bad.entries, options).find(bad.part), std::string::npos)
        << bad.entries[0] << ": " << wrongWith(bad.entries, options);
}

TEST(Renditions, AreReadWithTheBakesCodecUnlessTheyNameOne) {
  std::vector<LowerRendition> all;
  ASSERT_EQ(parseRenditions({"1024:36", "384:34", "512:50:av1", "0.5:34"}, named(), all), "");
  EXPECT_EQ(text(all), ".1024-36.384-34.512-50-av1.0.5-34");
  all.clear();
  ASSERT_EQ(parseRenditions({"384:60", "384:30:h264"}, named(encode::Codec::Av1), all), "");
  EXPECT_EQ(all[0].codec, encode::Codec::Av1);
  EXPECT_EQ(all[1].codec, encode::Codec::H264);
}

TEST(Renditions, TheStandardOnesFollowFromTheHighest) {
  EXPECT_EQ(text(standardRenditions(named())), ".384-34.1024-36");
  BakeOptions small = named();
  small.texture = 128;
  small.crf = 51;
  EXPECT_EQ(text(standardRenditions(small)), ".64-51") << "no coarser CRF is left for the highest's size";
  BakeOptions cameras = named();
  cameras.appearance = package::AppearanceKind::Cameras;
  EXPECT_EQ(text(standardRenditions(cameras)), ".0.5-34.1-36");
  for (const Quality& quality : qualities())
    for (const encode::Codec codec : {encode::Codec::H264, encode::Codec::Vp9, encode::Codec::Av1})
      for (const auto kind : {package::AppearanceKind::Layers, package::AppearanceKind::Cameras})
        for (const int texture : {128, 160, 512, 1024}) {
          BakeOptions options = named();
          applyQuality(quality, codec, options);
          options.texture = texture;
          options.appearance = kind;
          options.lower_renditions = standardRenditions(options);
          EXPECT_EQ(options.check(), "") << quality.name << " " << encode::infoOf(codec).name << " " << texture;
        }
}

TEST(Renditions, ThatCannotBeAreRefused) {
  expectBad({{{"384"}, "\"384\" is not SIZE:CRF"},
             {{"384:34:h264:slow"}, "is not SIZE:CRF"},
             {{":34"}, "is not SIZE:CRF"},
             {{"nan:34"}, "is not SIZE:CRF"},
             {{"384:34:hevc"}, "must be one of h264, vp9, av1"},
             {{"384:52"}, "0 to 51 for h264"},
             {{"384:64:av1"}, "0 to 63 for av1"},
             {{"384:-1"}, "0 to 51"},
             {{"384:30.5"}, "0 to 51"},
             {{"2048:36"}, "more texels than the highest, 1024"},
             {{"32:36"}, "multiple of 32 from 64"},
             {{"400:36"}, "multiple of 32 from 64"},
             {{"385:36"}, "multiple of 32 from 64"},
             {{"-384:36"}, "texels of layer 1"},
             {{"384:34", "512:34", "384:34"}, "384:34:h264: is listed twice"},
             {{"1024:29"}, "not below the highest"},
             {{"1024:20"}, "not below the highest"},
             {std::vector<std::string>(16, "384:34"), "at most 16 renditions"},
             {{"0.5:34"}, "texels of layer 1"}});
  BakeOptions cameras = named();
  cameras.appearance = package::AppearanceKind::Cameras;
  expectBad({{{"384:34"}, "share of the highest's sides"},
             {{"0.3:34"}, "multiple of 0.125"},
             {{"0:34"}, "multiple of 0.125"},
             {{"1:29"}, "not below the highest"}},
            cameras);
  EXPECT_EQ(wrongWith({"1024:28:av1", "384:20"}), "") << "of another codec or size: order follows from the bytes";
  std::vector<std::string> most;
  for (int crf = 30; most.size() < 15; ++crf) most.push_back("384:" + std::to_string(crf));
  EXPECT_EQ(wrongWith(most), "");
}

TEST(Renditions, OfAStreamHaveLayoutsOfTheirOwn) {
  BakeOptions options = named();
  options.lower_renditions = standardRenditions(options);
  StreamPlan stream;
  stream.motion.members.resize(4);
  RenditionPlan& highest = stream.renditions.emplace_back();
  highest.layout = encode::makeTileLayout(options.layers, options.texture, false, 4);
  highest.encode.fps = 27.5;
  addLowerRenditions(options, stream);
  ASSERT_EQ(stream.renditions.size(), 3u);
  EXPECT_TRUE(stream.renditions[1].shrunk);
  EXPECT_EQ(stream.renditions[1].layout.layers.size(), 12u);
  EXPECT_EQ(stream.renditions[1].layout.layers[1].width, 192);
  EXPECT_FALSE(stream.renditions[2].shrunk);
  for (const RenditionPlan& r : stream.renditions) {
    EXPECT_EQ(r.layout.width % 16, 0);
    EXPECT_EQ(r.layout.height % 16, 0);
    EXPECT_EQ(r.encode.fps, 27.5);
  }
  EXPECT_EQ(stream.renditions[2].layout.layers.size(), 12u);
  EXPECT_EQ(stream.renditions[2].layout.width, stream.layout().width);
  EXPECT_EQ(stream.renditions[2].layout.height, stream.layout().height);
  EXPECT_NEAR(ladderTexels(options), 2 + 9 / 64.0, 1e-9);
}

}  // namespace
}  // namespace fourdvt::bake
