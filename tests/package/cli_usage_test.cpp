// SPDX-License-Identifier: Apache-2.0
// Command-line mistakes: one line that names the option, exit code 2, nothing written.
#include <gtest/gtest.h>

#include <sstream>

#include "command.h"

namespace fourdvt::test {
namespace {

struct Mistake {
  const char* arguments;
  const char* named;  // must appear in the message
};

class Usage : public testing::TestWithParam<Mistake> {};

TEST_P(Usage, IsOneLineAndExitCode2) {
  const Outcome outcome = fourdvt(GetParam().arguments);
  EXPECT_EQ(outcome.code, 2) << outcome.output;
  EXPECT_TRUE(isOneLineWith(outcome, GetParam().named)) << outcome.output;
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, Usage,
    testing::Values(
        Mistake{"bake", "missing argument"}, Mistake{"bake capture", "-o"},
        Mistake{"bake capture -o", "-o needs a value"}, Mistake{"bake a b -o c", "\"b\""},
        Mistake{"bake a -o b --bogus", "--bogus"}, Mistake{"bake a -o b --layers x", "--layers"},
        Mistake{"bake a -o b --layers 7", "--layers"}, Mistake{"bake a -o b --layers 1.5", "--layers"},
        Mistake{"bake a -o b --crf --resume", "--crf needs a value"}, Mistake{"bake a -o b --crf nan", "--crf"},
        Mistake{"bake a -o b --texture 1000", "texture"}, Mistake{"bake a -o b --sequences walk,,run", "--sequences"},
        Mistake{"bake a -o b --codec hevc", "h264, vp9, av1"},
        Mistake{"bake a -o b --renditions 384", "--renditions: \"384\" is not SIZE:CRF"},
        Mistake{"bake a -o b --renditions 384:34:hevc", "h264, vp9, av1"},
        Mistake{"bake a -o b --renditions 2048:34", "more texels than the highest"},
        Mistake{"bake a -o b --renditions 384:34,384:34", "listed twice"},
        Mistake{"bake a -o b --renditions 384:34,", "--renditions"}, Mistake{"bake a -o b --crf 52", "--crf"},
        Mistake{"bake a -o b --codec vp9 --crf 64", "0 to 63"}, Mistake{"bake a -o b --preset 6", "veryslow"},
        Mistake{"bake a -o b --codec av1 --preset medium", "SVT-AV1"},
        Mistake{"bake a -o b --quality best", "draft, web, high"},
        Mistake{"bake a -o b --penalty angle", "axis, ray, resolution"},
        Mistake{"bake a -o b --filter nearest", "bilinear, mipmap, bicubic"},
        Mistake{"bake a -o b --texture 2048 --layers 4 --equal-layers", "4096"},
        Mistake{"bake a -o b --no-colour-calibration=1", "takes no value"},
        Mistake{"bake a -o b --refine mesh", "--refine must be outline or none"},
        Mistake{"bake a -o b --refine-cameras yes", "--refine-cameras must be on or off"},
        Mistake{"bake a -o b --matte-bias-px 20", "--matte-bias-px"},
        Mistake{"bake a -o b --refine none --refine-cameras off --matte-bias-px 1", "nothing to correct"},
        Mistake{"render a -o b.png --refine none", "belong to --method fvvr"},
        Mistake{"bake a -o b --resume=1", "--resume"}, Mistake{"bake a -o b -o c", "twice"},
        Mistake{"import", "missing argument"}, Mistake{"import a", "-o is required"},
        Mistake{"import a -o b --up --scale 1", "--up needs a value"},
        Mistake{"import a --up -o b", "--up needs a value"}, Mistake{"import -o b --up -Y", "missing argument"},
        Mistake{"import a -o b --up W", "--up must be X, -X, Y, -Y, Z or -Z"},
        Mistake{"import a -o b --scale 0", "--scale"}, Mistake{"import a -o b --fps 0", "--fps"},
        Mistake{"import a -o b --sequences walk", "NAME=FOLDER"}, Mistake{"import a -o b --sequences w=a,w=b", "twice"},
        Mistake{"import a -o b --loop walk", "--loop: no sequence \"walk\""},
        Mistake{"import a -o b --class l:s=take:1,run:2", "name them with --sequences"},
        Mistake{"import a -o b --sequences w=a,r=b --class l:s=w:1,run:2", "choose among: w, r"},
        Mistake{"import a -o b --sequences w=a,r=b --class l:s=w:1,r", "\"r\" has 0 values of 1"},
        Mistake{"import a -o b --sequences w=a,r=b --class l:s=w:1,r:2 --class l:s=w:1,r:2", "listed twice"},
        Mistake{"calibrate", "missing argument"}, Mistake{"calibrate a --most-offset 0", "--most-offset"},
        Mistake{"calibrate a --synchronise maybe", "--synchronise must be one of on, off"},
        Mistake{"calibrate a --synchronise off --refine-cameras off", "nothing to do"},
        Mistake{"reconstruct a -o b --refine-cameras no", "--refine-cameras must be one of on, off"},
        Mistake{"mattes", "missing argument"}, Mistake{"mattes a", "-o is required"},
        Mistake{"mattes a -o b --preview 0", "--preview"}, Mistake{"mattes a -o b --resume=1", "--resume"},
        Mistake{"inspect", "missing argument"}, Mistake{"inspect a --loud", "--loud"},
        Mistake{"inspect a --quiet --verbose", "exclude each other"}, Mistake{"render a", "--turntable"},
        Mistake{"render a -o b.gif", ".png"}, Mistake{"render a -o b.png --size 720", "--size"},
        Mistake{"render a -o b.png --size 0x9", "--size"},
        Mistake{"render a -o b.png --camera c --azimuth 3", "exclude"},
        Mistake{"render a -o b.png --cameras c", "--camera"},
        Mistake{"render a -o b.png --background red", "--background"},
        Mistake{"render a -o b.png --debug x", "--debug"}, Mistake{"render a -o b.png --azimuth 1e9", "--azimuth"},
        Mistake{"render a --turntable b.mp4 --size 101x100", "even"},
        Mistake{"render a -o b.png --capture c", "--method fvvr"}, Mistake{"render a -o b.png --method x", "--method"},
        Mistake{"render a -o b.png --capture c", "fvvr"},
        Mistake{"render a -o b.png --method layered --closest 3", "fvvr"},
        Mistake{"render a -o b.png --method fvvr --capture c --closest 0", "--closest"},
        Mistake{"render a -o b.png --method fvvr --capture c --visibility thick", "fattened"},
        Mistake{"render a -o b.png --method wireframe --visibility plain", "fvvr"},
        Mistake{"render a --turntable b.mp4 --method fvvr --capture c", "stills"},
        Mistake{"render a -o b.png --method fvvr --capture c --debug labels", "--debug"},
        Mistake{"render a --scene b.json -o c.png", "--scene"},
        Mistake{"render --scene a.json --class c -o b.png", "scene"}, Mistake{"render a -o b.mp4", "--sweep"},
        Mistake{"render a --sweep s=1:2 -o b.png", ".mp4"}, Mistake{"render a --sweep s -o b.mp4", "--sweep"},
        Mistake{"render a --play x@ -o b.mp4", "--play"},
        Mistake{"render a --sweep s=1:2 --play x@1 -o b.mp4", "exclude"},
        Mistake{"render a --parameter s -o b.png", "--parameter"}, Mistake{"render a --align x -o b.png", "--align"},
        Mistake{"render a --class c --sequence s -o b.png", "--class"},
        Mistake{"render a --phase 2 -o b.png", "--phase"}, Mistake{"render a --travel -o b.png", "--travel"},
        Mistake{"bake a -o b --labels naive", "--labels"}));

class LabUsage : public testing::TestWithParam<Mistake> {};

TEST_P(LabUsage, IsOneLineAndExitCode2) {
  const Outcome outcome = lab(GetParam().arguments);
  EXPECT_EQ(outcome.code, 2) << outcome.output;
  EXPECT_TRUE(isOneLineWith(outcome, GetParam().named)) << outcome.output;
  EXPECT_EQ(outcome.output.rfind("fourdvt-lab: ", 0), 0u) << outcome.output;
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, LabUsage,
    testing::Values(Mistake{"bake a -o b --labels best", "naive, spatial, temporal-paper, joint, per-texel"},
                    Mistake{"bake a -o b --layers 7", "--layers"}, Mistake{"study a", "-o is required"},
                    Mistake{"study a -o b --methods fvvr", "unknown option --methods"},
                    Mistake{"study a -o b --flicker 2", "unknown option --flicker"},
                    Mistake{"score a", "--capture is required"},
                    Mistake{"score a --capture b --refine none", "unknown option --refine"},
                    Mistake{"score a --capture b --input-every -1", "--input-every"},
                    Mistake{"score a --capture b --quick", "unknown option --quick"},
                    Mistake{"methods a --frames 2", "--frames needs -o"},
                    Mistake{"methods a --axis-frames 2", "--axis-frames needs -o"},
                    Mistake{"methods a --steps proxies", "--steps needs -o"},
                    Mistake{"study a -o b --views 3", "--views"}, Mistake{"methods a -o b --frames 0", "--frames"},
                    Mistake{"methods a -o b --closest 3", "--closest does not go with -o"},
                    Mistake{"methods a -o b --sweep-planes 8", "--sweep-planes does not go with -o"},
                    Mistake{"methods a --refine none", "unknown option --refine"},
                    Mistake{"methods a --character b", "unknown option --character"},
                    Mistake{"surfaces a --method fvvr", "unknown option --method"},
                    Mistake{"mattes", "missing argument"}, Mistake{"mattes a --refine none", "unknown option --refine"},
                    Mistake{"surfaces", "missing argument"}, Mistake{"drift a", "--reference is required"},
                    Mistake{"drift a --reference b --frame walk", "--frame must be SEQUENCE:NUMBER"},
                    Mistake{"drift a --reference b --within-mm 0", "--within-mm"}));

TEST(Usage, UnknownCommandListsThoseThatExist) {
  for (const char* arguments : {"", "fly"}) {
    const Outcome outcome = fourdvt(arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.output.find("reconstruct"), std::string::npos);
    const Outcome of_lab = lab(arguments);
    EXPECT_EQ(of_lab.code, 2);
    EXPECT_NE(of_lab.output.find("surfaces"), std::string::npos);
  }
}

TEST(Usage, EveryCommandHasHelp) {
  EXPECT_EQ(fourdvt("--help").code, 0);
  EXPECT_EQ(fourdvt("--version").code, 0);
  EXPECT_EQ(lab("--version").output.rfind("fourdvt-lab ", 0), 0u);
  for (const std::string command : {"reconstruct", "bake", "inspect", "render"}) {
    const Outcome outcome = fourdvt(command + " --help");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.output.rfind("usage: fourdvt " + command, 0), 0u) << outcome.output;
  }
  for (const std::string command : {"studio", "study", "score", "methods", "mattes", "surfaces", "drift"}) {
    const Outcome outcome = lab(command + " --help");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.output.rfind("usage: fourdvt-lab " + command, 0), 0u) << outcome.output;
  }
  EXPECT_NE(lab("bake --help").output.find("--labels"), std::string::npos);
}

// Limit of one screen: 24 lines of 120 characters.
TEST(Usage, HelpOfTheJudgingCommandsFitsAScreen) {
  for (const std::string command : {"study", "score", "methods", "mattes", "surfaces", "drift"}) {
    std::istringstream lines(lab(command + " --help").output);
    std::string line;
    int count = 0;
    for (; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 140u) << command << ": " << line;
    EXPECT_LE(count, 24) << command;
  }
}

// Errors are printed at every level, options only with --verbose.
TEST(Usage, LevelsOfWhatIsPrinted) {
  const std::string command = "render no-such-folder -o x.png";
  EXPECT_TRUE(isOneLineWith(fourdvt(command + " --quiet"), "no-such-folder"));
  const std::string normal = fourdvt(command).output, verbose = fourdvt(command + " --verbose").output;
  EXPECT_EQ(normal.find("--align"), std::string::npos) << normal;
  EXPECT_NE(verbose.find("no-such-folder --align baked"), std::string::npos) << verbose;
  EXPECT_NE(verbose.find(" s in all"), std::string::npos) << verbose;
  for (const char* help : {"bake --help", "job --help", "live --help"})
    EXPECT_NE(fourdvt(help).output.find("--quiet, --verbose"), std::string::npos) << help;
}

TEST(Usage, NegativeNumbersAreValues) {
  const Outcome outcome = fourdvt("render no-such-folder -o x.png --azimuth -30 --elevation -5");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.output.find("no-such-folder"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace fourdvt::test
