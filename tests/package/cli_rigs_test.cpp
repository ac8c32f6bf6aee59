// SPDX-License-Identifier: Apache-2.0
// Rigs other than a ring of equal cameras: lenses shifted so far that their optical axes miss the pictures, and
// pictures that are rotated, larger than others, or cropped. Their bakes are about as good as one of the same box from
// a plain rig.
#include <gtest/gtest.h>

#include <map>

#include "command.h"

namespace fourdvt::test {
namespace {

struct Rig {
  const char* name;
  double worse_dB;  // tolerance: shifted lenses sample on another grid; a mixed rig has more pixels
};

class Rigs : public ::testing::TestWithParam<Rig> {
 protected:
  // PSNR at the held-out camera, which all rigs share.
  static double score(const std::string& appearance, const std::string& rig) {
    const std::string name = rig + "-" + appearance, capture = smallCapture("rig-" + name, 3, rig);
    const std::string character = scratch("rig-out-" + name) + "/box";
    const std::string layers = appearance == "layers" ? " --layers 3 --texture 256 --equal-layers" : "";
    const Outcome bake = fourdvt("bake " + capture + " -o " + character + " --appearance " + appearance + layers +
                                 " --gop 3 --renditions highest --jobs 2");
    EXPECT_EQ(bake.code, 0) << bake.output;
    const Outcome scored = lab("score " + character + " --capture " + capture + " --input-every 0 --flicker 0");
    EXPECT_EQ(scored.code, 0) << scored.output;
    const size_t row = scored.output.find("test00");
    if (row == std::string::npos) return 0;
    int views = 0;
    double psnr = 0;
    EXPECT_EQ(std::sscanf(scored.output.c_str() + row, "test00 %d %lf", &views, &psnr), 2);
    return psnr;
  }
  static double plain(const std::string& appearance) {
    static std::map<std::string, double> known;
    if (!known.contains(appearance)) known[appearance] = score(appearance, "plain");
    EXPECT_GT(known[appearance], 25);
    return known[appearance];
  }
};

TEST_P(Rigs, ShowWhatAPlainOneShows) {
  for (const char* appearance : {"cameras", "layers"})
    EXPECT_GT(score(appearance, GetParam().name), plain(appearance) - GetParam().worse_dB) << appearance;
}

INSTANTIATE_TEST_SUITE_P(Kinds, Rigs, ::testing::Values(Rig{"shifted", 0.7}, Rig{"mixed", 0.1}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace fourdvt::test
