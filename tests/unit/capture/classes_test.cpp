// SPDX-License-Identifier: Apache-2.0
// The classes of capture.json: valid ones, and one message that names the file for invalid ones.
#include "capture/capture_json.h"
#include "capture_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

// walk, run, sprint, jog, trot are loops; pickup and wave end.
Result<DeclaredCapture> parse(const std::string& classes) {
  std::string sequences;
  for (const char* loop : {"walk", "run", "sprint", "jog", "trot"})
    sequences += std::string(R"({"name": ")") + loop + R"(", "frames": 3, "loop": true}, )";
  sequences += R"({"name": "pickup", "frames": 3}, {"name": "wave", "frames": 3})";
  const std::string text = R"({"fps": 25, "sequences": [)" + sequences + R"(], "classes": )" + classes + "}";
  return parseCaptureJson(text, "capture");
}

std::string locomotion(const std::string& members, const std::string& parameter = R"("speed_mps")") {
  return R"([{"name": "locomotion", "parameter": )" + parameter + R"(, "members": )" + members + "}]";
}

// `named`: text that the message must contain besides the file.
void expectRefused(const std::string& classes, const std::string& named) {
  const auto parsed = parse(classes);
  expectError(parsed, ErrorId::CaptureJson, "capture/capture.json");
  if (!parsed.ok()) {
    EXPECT_NE(parsed.error().message.find(named), std::string::npos) << parsed.error().message;
  }
}

TEST(CaptureClasses, NoneIsFine) {
  EXPECT_TRUE(parse("[]").value().capture.classes.empty());
  EXPECT_TRUE(parse("null").value().capture.classes.empty());
}

TEST(CaptureClasses, MembersByName) {
  const auto parsed = parse(locomotion(R"(["walk", "run"])"));
  ASSERT_TRUE(parsed.ok()) << parsed.error().message;
  ASSERT_EQ(parsed.value().capture.classes.size(), 1u);
  const CaptureClass& c = parsed.value().capture.classes[0];
  EXPECT_EQ(c.name, "locomotion");
  EXPECT_EQ(c.parameters, std::vector<std::string>{"speed_mps"});
  ASSERT_EQ(c.members.size(), 2u);
  EXPECT_EQ(c.members[1].sequence, "run");
  EXPECT_TRUE(c.members[1].parameter.empty()) << "to be measured";
}

TEST(CaptureClasses, MembersWithValuesOfOneOrTwoParameters) {
  const auto one =
      parse(locomotion(R"([{"sequence": "walk", "value": 1.25}, {"sequence": "run", "value": [2.5]}, "jog"])"));
  ASSERT_TRUE(one.ok()) << one.error().message;
  EXPECT_EQ(one.value().capture.classes[0].members[0].parameter, std::vector<double>{1.25});
  EXPECT_EQ(one.value().capture.classes[0].members[1].parameter, std::vector<double>{2.5});
  const auto two =
      parse(locomotion(R"([{"sequence": "pickup", "value": [1, 0]}, {"sequence": "wave", "value": [2, -30]}])",
                       R"(["height_m", "turn_dps"])"));
  ASSERT_TRUE(two.ok()) << two.error().message;
  EXPECT_EQ(two.value().capture.classes[0].parameters.size(), 2u);
  EXPECT_EQ(two.value().capture.classes[0].members[1].parameter, (std::vector<double>{2, -30}));
}

TEST(CaptureClasses, UnknownSequence) {
  expectRefused(locomotion(R"(["walk", "fly"])"), "choose among: walk, run");
  expectRefused(locomotion(R"(["walk", 7])"), "no sequence");
  expectRefused(locomotion(R"(["walk", {"value": 2}])"), "no sequence");
}

TEST(CaptureClasses, TooFewOrTooManyMembers) {
  for (const char* members : {"[]", "null", R"("walk")", R"(["walk"])", R"(["walk", "run", "sprint", "jog", "trot"])"})
    expectRefused(locomotion(members), "2 to 4");
  EXPECT_TRUE(parse(locomotion(R"(["walk", "run", "sprint", "jog"])")).ok());
}

TEST(CaptureClasses, AMemberTwice) { expectRefused(locomotion(R"(["walk", "run", {"sequence": "walk"}])"), "twice"); }

TEST(CaptureClasses, ValuesOfTheWrongLength) {
  const auto walkAt = [](const std::string& value) {
    return R"([{"sequence": "walk", "value": )" + value + R"(}, "run"])";
  };
  for (const char* value : {"[]", "[1, 2]", R"("fast")", "[null]", "true", "1e300"})
    expectRefused(locomotion(walkAt(value)), "one number for each");
  for (const char* value : {"1", "[1]", "[1, 2, 3]"})
    expectRefused(locomotion(walkAt(value), R"(["speed_mps", "turn_dps"])"), "one number for each");
}

TEST(CaptureClasses, Names) {
  const std::string rest = R"(, "parameter": "speed_mps", "members": ["walk", "run"]})";
  expectRefused(R"([{"name": "walk")" + rest + "]", "name of a sequence");
  expectRefused(R"([{"name": "l")" + rest + R"(, {"name": "l")" + rest + "]", "twice");
  for (const char* name : {R"("")", R"("a/b")", R"(".l")", "3", "null"})
    expectRefused(std::string(R"([{"name": )") + name + rest + "]", "could name a file");
  expectRefused("[7]", "could name a file");
  expectRefused("{}", "must be a list");
}

TEST(CaptureClasses, ParameterNames) {
  for (const char* parameter : {"null", "1", R"("")", "[]", R"(["a", 2])", R"(["a", "a"])", R"(["a", "b", "c"])"})
    expectRefused(locomotion(R"(["walk", "run"])", parameter), "speed_mps");
}

TEST(CaptureClasses, LoopsMixedWithMotionsThatEnd) {
  expectRefused(locomotion(R"(["walk", "pickup"])"), "mixes a loop");
  expectRefused(locomotion(R"(["wave", "pickup", "run"])"), "mixes a loop");
  EXPECT_TRUE(parse(locomotion(R"(["wave", "pickup"])")).ok());
}

// The sample declares walk and run as one class.
TEST(CaptureClasses, OnlyThoseWhoseMembersAreAllAsked) {
  const auto classesOf = [](const std::vector<std::string>& only) {
    auto capture = mattes::openCapture(kSample, platform::openVideoFile, only);
    EXPECT_TRUE(capture.ok());
    return capture.ok() ? capture.value().classes.size() : size_t(99);
  };
  EXPECT_EQ(classesOf({"run", "walk"}), 1u);
  EXPECT_EQ(classesOf({"run"}), 0u);
}

}  // namespace
}  // namespace fourdvt::capture
