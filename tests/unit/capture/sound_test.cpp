// SPDX-License-Identifier: Apache-2.0
// "audio" of sequences and "footsteps" of classes in capture.json.
#include "capture/capture_json.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

Result<DeclaredCapture> parse(const std::string& of_sequence, const std::string& of_class = "\"name\": \"c\"") {
  return parseCaptureJson(R"({"fps": 25, "sequences": [{"name": "a", "frames": 9)" + of_sequence +
                              R"(}, {"name": "b", "frames": 9}], "classes": [{"parameter": "p", "members": [)" +
                              R"({"sequence": "a", "value": 0}, {"sequence": "b", "value": 1}], )" + of_class + "}]}",
                          "/capture");
}

TEST(CaptureSound, IsAPathOrAPathAndAnOffset) {
  EXPECT_FALSE(parse("").value().sequences[0].sequence.sound.has_value());
  const auto plain = parse(R"(, "audio": "a/sound.wav")");
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  EXPECT_EQ(plain.value().sequences[0].sequence.sound->path, "/capture/a/sound.wav");
  EXPECT_EQ(plain.value().sequences[0].sequence.sound->offset_s, 0);
  EXPECT_FALSE(plain.value().sequences[1].sequence.sound.has_value());
  const auto late = parse(R"(, "audio": {"file": "s.m4a", "offset_ms": -12.5})");
  EXPECT_DOUBLE_EQ(late.value().sequences[0].sequence.sound->offset_s, -0.0125);
  const auto steps = parse("", R"("name": "c", "footsteps": {"file": "step.wav", "offset_ms": 5})");
  ASSERT_TRUE(steps.ok()) << steps.error().message;
  ASSERT_TRUE(steps.value().capture.classes[0].footstep.has_value());
  EXPECT_EQ(steps.value().capture.classes[0].footstep->path, "/capture/step.wav");
}

TEST(CaptureSound, WrongOnesAreNamed) {
  for (const char* wrong :
       {"7", "[]", "{}", R"({"offset_ms": 4})", R"({"file": 3})", R"({"file": "a.wav", "offset_ms": "1"})",
        R"({"file": "a.wav", "offset_ms": 1e12})", R"("")"})
    expectError(parse(std::string(", \"audio\": ") + wrong), ErrorId::CaptureJson, "\"audio\" of \"a\"");
  for (const char* outside : {R"("../a.wav")", R"("/etc/passwd")", R"({"file": "x/../../a.wav"})"})
    expectError(parse(std::string(", \"audio\": ") + outside), ErrorId::CaptureJson, "leads out of the capture folder");
  expectError(parse("", R"("name": "c", "footsteps": 1)"), ErrorId::CaptureJson, "\"footsteps\" of class \"c\"");
}

}  // namespace
}  // namespace fourdvt::capture
