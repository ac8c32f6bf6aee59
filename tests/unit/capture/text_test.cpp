// SPDX-License-Identifier: Apache-2.0
// Lines, words, numbers and places of errors, for all readers of text.
#include "capture/text.h"

#include <clocale>
#include <nlohmann/json.hpp>

#include "capture/import/readers.h"
#include "capture/mesh_file.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

std::vector<std::string> linesOf(std::string_view text, TextLines::Rules rules = {}) {
  TextLines lines(text, rules);
  std::vector<std::string> out;
  for (std::string_view line; lines.next(line);)
    out.push_back(std::to_string(lines.number()) + ":" + std::string(line));
  return out;
}

using Texts = std::vector<std::string>;

TEST(Text, LinesEndInEveryWayAndAMarkIsSkipped) {
  const Texts expected{"1:a b", "3:c"};
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string e = end;
    EXPECT_EQ(linesOf("\xef\xbb\xbf"
                      "a b" +
                      e + " \t" + e + "c" + e + "# note" + e),
              expected)
        << int(*end);
    EXPECT_EQ(linesOf("a b" + e + e + "c"), expected) << "without an end";
  }
  EXPECT_EQ(linesOf("a\n\nb", {.blank_lines = true}), (Texts{"1:a", "2:", "3:b"}));
  EXPECT_EQ(linesOf("# a\nb # c\nd#e", {.comment = 0}), (Texts{"1:# a", "2:b # c", "3:d#e"}));
  EXPECT_EQ(linesOf("b\t# c\nd#e", {.comment_behind = true}), (Texts{"1:b\t", "2:d#e"}));
}

TEST(Text, ContinuedLinesKeepTheNumberOfTheirBeginning) {
  EXPECT_EQ(linesOf("a \\\r\nb\\\nc\nd", {.continued = true}), (Texts{"1:a  b c", "4:d"}));
  EXPECT_EQ(linesOf("a \\", {.continued = true}), Texts{"1:a  "});
  EXPECT_EQ(linesOf("a \\\nb"), (Texts{"1:a \\", "2:b"}));
  EXPECT_EQ(linesOf("# D:\\scans\\\nb", {.continued = true}), Texts{"2:b"}) << "a comment ends with its line";
}

TEST(Text, NumbersDoNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
    std::setlocale(LC_ALL, locale);
    Fields fields("\t1.5  +2e1 -3");
    EXPECT_EQ(fields.number<double>(), 1.5);
    EXPECT_EQ(fields.number<float>(), 20);
    EXPECT_EQ(fields.number<int>(), -3);
    EXPECT_EQ(fields.problem(), "");
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST(Text, WordsThatAreNoNumbersAreNamed) {
  EXPECT_EQ(numberProblem("1,5"), "\"1,5\" has a decimal comma (write 1.5, not 1,5)");
  EXPECT_EQ(numberProblem("-1,5e-3"), "\"-1,5e-3\" has a decimal comma (write -1.5e-3, not -1,5e-3)");
  EXPECT_EQ(numberProblem("1,2,3"), "\"1,2,3\" is no number");
  EXPECT_EQ(numberProblem("nan"), "\"nan\" is no finite number");
  EXPECT_EQ(numberProblem("-inf"), "\"-inf\" is no finite number");
  EXPECT_EQ(numberProblem(""), "a number is missing");
  EXPECT_EQ(numberProblem(std::string(100, 'x')), "\"" + std::string(40, 'x') + "...\" is no number");
  EXPECT_EQ(numberProblem("a\x01"), "\"a?\" is no number");
  Fields fields("1 1.5 2 x");
  fields.number<int>();
  EXPECT_EQ(fields.number<int>(), 0);
  fields.number<int>();
  fields.number<int>();
  EXPECT_EQ(fields.problem(), "\"1.5\" is no whole number") << "the first";
  Fields rest("1   cam 00 (1).png \t");
  rest.word();
  EXPECT_EQ(rest.rest(), "cam 00 (1).png");
}

TEST(Text, BytesLieInLines) {
  const std::string text = "ab\r\nc\rd\n";
  const int lines[] = {1, 1, 1, 1, 2, 2, 3, 3};
  for (size_t i = 0; i < text.size(); ++i) EXPECT_EQ(lineOfByte(text, i), lines[i]) << i;
  EXPECT_EQ(lineOfByte(text, 100), 3);
  EXPECT_EQ(lineOfByte("", 0), 1);
}

TEST(Text, JsonNamesTheLineAndTheReason) {
  const auto wrong = [](const std::string& text, const std::string& words) {
    auto json = parseJsonText(text, "a.json", ErrorId::CaptureJson);
    expectError(json, ErrorId::CaptureJson, words);
  };
  wrong("{\n \"a\": 1,5\n}", "a.json:2: \"1,5\" has a decimal comma (write 1.5, not 1,5)");
  wrong("{\n\n \"a\": [1.0, NaN]}", "a.json:3: \"NaN\" is no finite number");
  wrong("{\"a\": -Infinity}", "a.json:1: \"-Infinity\" is no finite number");
  wrong("{\n \"a\": 1\n \"b\": 2}", "a.json:3: not valid JSON");
  wrong("", "a.json:1: not valid JSON");
  wrong(std::string(70, '[') + std::string(70, ']'), "a.json: nested deeper than 64");
  EXPECT_TRUE(parseJsonText("\xef\xbb\xbf{\"a\":\r\n\t1}\r\n", "a.json", ErrorId::CaptureJson).ok());
}

// Every reader of text names the file, the line and the decimal comma.
TEST(Text, DecimalCommasAreRefusedByEveryReader) {
  const std::string words = "write 1.5, not 1,5";
  const auto named = [&](const auto& result, const std::string& place) {
    ASSERT_FALSE(result.ok()) << place;
    EXPECT_NE(result.error().message.find(place), std::string::npos) << result.error().message;
    EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
  };
  const std::string camera = "1 PINHOLE 64 48 50 50 32 24\n";
  named(parseColmapText("# c\n1 PINHOLE 64 48 1,5 50 32 24\n", "1 1 0 0 0 0 0 3 1 a\n", "m"), "m/cameras.txt:2");
  named(parseColmapText(camera, "\n1 1 0 0 0 0 1,5 3 1 a\n", "m"), "m/images.txt:2");
  named(parseObj("v 0 0 0\nv 1,5 0 0\n", "a.obj"), "a.obj:2");
  named(parseObj("v 0 0 0\nvt 1,5 0\n", "a.obj"), "a.obj:2");
  named(parseMesh("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1,5 0 0\n3 0 0 0\n",
                  "a.ply"),
        "a.ply:11");
  named(parseProjection("1 0 0 0\n0 1,5 0 0\n0 0 1 1\n", "v", "v.txt"), "v.txt:2");
  named(parseActorsHq("name;w;h;rx;ry;rz;tx;ty;tz;fx;fy;px;py\nC;16;12;0;1,5;0;0;0;0;1;1;.5;.5\n", "c.csv"), "c.csv:2");
  named(parseActorsHq("name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py\nC,16,12,0,1,5,0,0,0,0,1,1,.5,.5\n", "c.csv"), "c.csv:2");
  named(parseNerfstudio("{\"frames\": [\n{\"fl_x\": 1,5}]}", "t.json"), "t.json:2");
  named(parseOpenCvCamera("K: [1,5, 0, 8, 0, 20, 6, 0, 0, 1]\nR: [0, 0, 0]\nT: [0, 0, 3]\n", "a", "a.yml"), "a.yml");
  named(parseOpenCvCamera("<opencv_storage><K>1,5 0 8 0 20 6 0 0 1</K></opencv_storage>", "a", "a.xml"), "a.xml");
  named(parseQualisys(
            "<calibration><cameras>\n<camera serial=\"7\"><fov_video left=\"1,5\"/></camera></cameras></calibration>",
            "q.qca.txt"),
        "q.qca.txt:2");
  named(parseToml("[a]\nmatrix = [[1,5, 0, 8], [0, 20, 6], [0, 0, 1]]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3]\n",
                  "c.toml"),
        "c.toml: [a]");
}

// With a byte-order mark, Windows' line ends, tabs and comments, every line-based format reads the same.
TEST(Text, EveryReaderTakesMarksTabsAndLineEnds) {
  const std::string mark = "\xef\xbb\xbf";
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    auto colmap = parseColmapText(mark + "# c" + end + end + "\t1\tPINHOLE 64 48 50 50 32 24" + end,
                                  mark + "1 1 0\t0 0 0 0 3 1 a.png" + end + end, "m");
    EXPECT_TRUE(colmap.ok()) << colmap.error().message;
    EXPECT_TRUE(parseObj(mark + "# c" + end + "v 0 0 0 # first" + end + "v\t1 0 0" + end + "v 1 1 0" + end + "vt 0 0" +
                             end + "f 1/1 2/1 3/1 # one" + end,
                         "a")
                    .ok());
    const std::string ply = mark + "ply" + end + "comment c" + end + "format ascii 1.0" + end + "element vertex 3" +
                            end + "property float x" + end + "property float y" + end + "property float z" + end +
                            "element face 1" + end + "property list uchar int vertex_indices" + end + "end_header" +
                            end + "0\t0 0" + end + end + "1 0 0" + end + "1 1 0" + end + "3 0 1 2" + end;
    auto mesh = parseMesh(ply, "a.ply");
    EXPECT_TRUE(mesh.ok()) << mesh.error().message;
    auto csv = parseActorsHq(
        "name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py" + end + end + "\"C\",16,12,0,0,0,0,0,\t0,1,1,.5,.5,," + end, "c.csv");
    ASSERT_TRUE(csv.ok()) << csv.error().message;
    EXPECT_EQ(csv.value().cameras[0].camera.pinhole.name, "C");
    EXPECT_TRUE(
        parseProjection(mark + "# P" + end + "20 0 8 0" + end + "0\t20 6 0" + end + "0 0 1 3" + end, "v", "v").ok());
  }
}

}  // namespace
}  // namespace fourdvt::capture
