// SPDX-License-Identifier: Apache-2.0
#include "platform/shader_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace fourdvt::platform {
namespace {

class PlatformShaderFolder : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const char* name, const char* text) const { std::ofstream(folder_ + "/" + name) << text; }
  const std::string folder_ = testing::TempDir() + "/fourdvt_shaders_" + std::to_string(::getpid());
};

// Line number as reported by a GLSL compiler: counted from the last #line above.
size_t countedLine(std::string_view text, const std::string& wanted) {
  std::istringstream lines{std::string(text)};
  size_t number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    if (line == wanted) return number;
    if (line.rfind("#line ", 0) == 0) number = std::stoul(line.substr(6)) - 1;
  }
  return 0;
}

TEST_F(PlatformShaderFolder, MessagesNameFileAndLine) {
  write("a.frag", "first\n#include \"part.glsl\"\n#include \"part.glsl\"\nlast\n");
  write("part.glsl", "\ninside\n");
  auto folder = ShaderFolder::open(folder_);
  ASSERT_TRUE(folder.ok());
  const std::string text(folder.value().text("a.frag"));
  EXPECT_EQ(text.find("inside"), text.rfind("inside"));
  for (const auto& [line, place] : {std::pair{"first", "a.frag:1"}, {"inside", "part.glsl:2"}, {"last", "a.frag:4"}}) {
    const std::string number = std::to_string(countedLine(text, line));
    EXPECT_EQ(folder.value().nameLines("x 0:" + number + "(7): error"), std::string("x ") + place + "(7): error");
    EXPECT_EQ(folder.value().nameLines("0(" + number + ") : error"), std::string(place) + ") : error");
  }
  EXPECT_EQ(folder.value().nameLines("0:12(7): no line of theirs, 123456789"), "0:12(7): no line of theirs, 123456789");
}

TEST_F(PlatformShaderFolder, WhatIsMissingIsNamed) {
  EXPECT_EQ(ShaderFolder::open(folder_).error().id, ErrorId::FileMissing);
  write("b.vert", "#include \"absent.glsl\"\n");
  auto folder = ShaderFolder::open(folder_);
  ASSERT_TRUE(folder.ok());
  EXPECT_NE(folder.value().text("b.vert").find("#error " + folder_ + " has no absent.glsl"), std::string_view::npos);
  EXPECT_NE(folder.value().text("c.frag").find("has no c.frag"), std::string_view::npos);
}

}  // namespace
}  // namespace fourdvt::platform
