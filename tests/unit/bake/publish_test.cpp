// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "bake/run/character_files.h"
#include "base/hash.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;  // name → content

struct Publish : testing::Test {
  fs::path folder = fs::path(testing::TempDir()) / ("publish_test_" + std::to_string(getpid()));
  std::string from = (folder / "work/result").string(), to = (folder / "character").string();
  void SetUp() override { fs::remove_all(folder); }
  void TearDown() override { fs::remove_all(folder); }
  static void write(const std::string& in, const Files& files) {
    for (const auto& [name, content] : files) {
      fs::create_directories(fs::path(in + "/" + name).parent_path());
      std::ofstream(in + "/" + name, std::ios::binary) << content;
    }
  }
  Files held() const {
    Files out;
    for (const auto& entry : fs::recursive_directory_iterator(to)) {
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string name = fs::relative(entry.path(), to).string();
      out[name] = entry.is_directory() ? "folder" : std::string(std::istreambuf_iterator<char>(in), {});
    }
    return out;
  }
};

// Manifest with one sequence and one camera; `mark`: hash in the file names, with its dot.
std::string manifest(const std::string& mark, const std::string& sequence = "walk") {
  const auto uri = [&](const std::string& stem, const std::string& end) {
    return R"({"uri": ")" + stem + mark + end + R"("})";
  };
  return R"({"images": [)" + uri("texture", ".jpg") +
         R"(], "extensions": {"FOURDVT_layered_video_texture": {"poster": {"uri": "poster.webp"}, "mesh": )" +
         uri("mesh", ".bin") + R"(, "graph": )" + uri("motion", ".bin") + R"(, "room": )" + uri("room", ".jpg") +
         R"(, "start": {"uri": "character.start.bin"}, "cameras": [{"name": "cam00"}], "sequences": [{"name": ")" +
         sequence + R"(", "stream": )" + uri(sequence, ".bin") + R"(, "renditions": [)" +
         uri(sequence + ".64-30", ".mp4") + ", " + uri(sequence, ".mp4") + "]}]}}}";
}

// Files of a bake, and those that stay beside the manifest.
Files baked(const std::string& mark, const std::string& content, const std::string& sequence = "walk") {
  Files files{{"character.gltf", manifest(mark, sequence)}};
  for (const char* stem : {"mesh", "motion"}) files[stem + mark + ".bin"] = content;
  for (const char* stem : {"texture", "room"}) files[stem + mark + ".jpg"] = content;
  files[sequence + mark + ".bin"] = files[sequence + mark + ".mp4"] = files[sequence + ".64-30" + mark + ".mp4"] =
      content;
  for (const char* name : {"poster.webp", "character.start.bin", "report.html", "report.json", "report_tiles.jpg"})
    files[name] = content;
  files["report_" + sequence + ".jpg"] = content;
  return files;
}

TEST_F(Publish, NewFolderHoldsTheResult) {
  const Files files = baked(".aaaaaaaa", "new");
  write(from, files);
  ASSERT_TRUE(publish(from, to).ok());
  EXPECT_EQ(held(), files);
}

TEST_F(Publish, ReplacesAnotherBakeAndKeepsOtherFiles) {
  for (const char* old_mark : {"", ".bbbbbbbb"}) {  // names without hashes: earlier versions
    SCOPED_TRACE(old_mark);
    fs::remove_all(folder);
    write(to, baked(old_mark, "old", "run"));
    write(to, {{"report_outline_cam00.jpg", "old"}, {"cameras_refined/images.txt", "old"}});
    const Files others{{"LICENSE.txt", "mine"}, {"walk.cccccccc.bin", "mine"}, {"report_of_mine.jpg", "mine"}};
    write(to, others);
    Files expected = baked(".aaaaaaaa", "new");
    write(from, expected);
    ASSERT_TRUE(publish(from, to).ok());
    expected.insert(others.begin(), others.end());
    EXPECT_EQ(held(), expected);
  }
}

TEST_F(Publish, SameBakeAgainIsKept) {
  const Files files = baked(".aaaaaaaa", "same");
  for (int i = 0; i < 2; ++i) {
    write(from, files);
    ASSERT_TRUE(publish(from, to).ok());
    EXPECT_EQ(held(), files);
  }
}

// Names in a foreign manifest must not lead outside the folder.
TEST_F(Publish, RemovesNothingOutsideItsFolder) {
  for (const std::string name : {"../secret.bin", "/../secret.bin", "parts/../../secret.bin"}) {
    std::string gltf = manifest(".bbbbbbbb", "run");
    gltf.replace(gltf.find("mesh.bbbbbbbb.bin"), 17, name);
    gltf.replace(gltf.find("\"cam00\""), 7, "\"/../../secret\"");
    write(to, {{"character.gltf", gltf}, {"parts/mine.txt", "mine"}, {"report_outline_/mine.txt", "mine"}});
    write(folder.string(), {{"secret.bin", "mine"}, {"secret.jpg", "mine"}});
    write(from, baked(".aaaaaaaa", "new"));
    ASSERT_TRUE(publish(from, to).ok());
    EXPECT_TRUE(fs::exists(folder / "secret.bin") && fs::exists(folder / "secret.jpg")) << name;
    EXPECT_EQ(held()["parts/mine.txt"], "mine");
  }
}

TEST_F(Publish, LeavesFilesOfAGltfThatIsNoBakes) {
  write(to,
        {{"character.gltf", R"({"images": [{"uri": "skin.jpg"}]})"}, {"skin.jpg", "mine"}, {"report.json", "mine"}});
  write(from, {{"character.gltf", manifest(".aaaaaaaa")}});
  ASSERT_TRUE(publish(from, to).ok());
  EXPECT_EQ(held()["skin.jpg"], "mine");
  EXPECT_EQ(held()["report.json"], "mine");
}

// A file that cannot be replaced: the earlier character stays complete, without leftovers.
TEST_F(Publish, FailureLeavesTheEarlierCharacter) {
  Files old = baked(".bbbbbbbb", "old");
  old.erase("report.html");
  write(to, old);
  write(to, {{"report.html/mine.txt", "mine"}});
  write(from, baked(".aaaaaaaa", "new"));
  const Status status = publish(from, to);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().id, ErrorId::WriteFailed);
  EXPECT_NE(status.error().message.find("report.html"), std::string::npos);
  const Files now = held();
  EXPECT_EQ(now.at("character.gltf"), old.at("character.gltf"));
  for (const char* name : {"mesh.bbbbbbbb.bin", "walk.bbbbbbbb.bin", "walk.bbbbbbbb.mp4", "texture.bbbbbbbb.jpg"})
    EXPECT_EQ(now.count(name), 1u) << name;
  for (const auto& [name, content] : now) EXPECT_EQ(name.find("aaaaaaaa"), std::string::npos) << name;
}

// The manifest is moved last, after all its files.
TEST_F(Publish, ManifestComesLast) {
  write(to, baked(".bbbbbbbb", "old"));
  Files files = baked(".aaaaaaaa", "new");
  write(from, files);
  fs::remove(to + "/character.gltf");
  fs::create_directories(to + "/character.gltf/in the way");
  ASSERT_FALSE(publish(from, to).ok());
  EXPECT_TRUE(fs::exists(from + "/character.gltf"));
  files.erase("character.gltf");
  for (const auto& [name, content] : files) EXPECT_FALSE(fs::exists(from + "/" + name)) << name;
}

TEST_F(Publish, NamesHoldTheContentsHash) {
  EXPECT_EQ(contentName("walk.1024-36.mp4", 0x0f9a1c2055667788), "walk.1024-36.0f9a1c20.mp4");
  std::string large(3'000'001, 'x');
  large[2'500'000] = 'y';
  write(to, {{"walk.bin", large}});
  const auto written =
      writeNamed(to, "copy.bin", std::span(reinterpret_cast<const uint8_t*>(large.data()), large.size()));
  const auto named = nameByContent(to, "walk.bin");
  ASSERT_TRUE(written && named);
  EXPECT_EQ(named.value(), contentName("walk.bin", fnv1a(large)));
  EXPECT_EQ(written.value(), contentName("copy.bin", fnv1a(large)));
  EXPECT_EQ(held(), (Files{{written.value(), large}, {named.value(), large}}));
}

}  // namespace
}  // namespace fourdvt::bake
