// SPDX-License-Identifier: Apache-2.0
// Bakes of a valid capture, an interrupted bake, output places that cannot be written, invalid captures.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "../unit/character_files.h"
#include "base/hash.h"
#include "command.h"
#include "package/stream_file.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kSmall = " --texture 128 --layers 2 --gop 4 --jobs 2 --renditions highest";

// Expects that the failed bake left nothing behind, except possibly the kept work folder.
void expectFailure(const Outcome& outcome, const std::string& named, const std::string& character) {
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  const size_t at = outcome.output.find("fourdvt: ");
  ASSERT_NE(at, std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find(named, at), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find('\n', at), outcome.output.size() - 1) << outcome.output;
  EXPECT_FALSE(exists(character));
}

// Flicker levels of every pair of pictures, by "sequence,camera".
std::map<std::string, std::vector<double>> flickerRows(const std::string& path) {
  std::map<std::string, std::vector<double>> out;
  std::istringstream lines(readText(path));
  std::string line;
  const std::string kind = "flicker,";
  while (std::getline(lines, line))
    if (line.rfind(kind, 0) == 0) {
      const size_t end = line.find(',', line.find(',', kind.size()) + 1);
      out[line.substr(kind.size(), end - kind.size())].push_back(std::stod(line.substr(line.rfind(',') + 1)));
    }
  return out;
}

TEST(Bake, MakesACharacterThatInspectsAndRenders) {
  const std::string capture = smallCapture("good-capture"), out = scratch("good");
  const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box" + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_FALSE(exists(out + "/box.work"));
  for (const char* file : {"/box/character.gltf", "/box.report/report.json", "/box.report/report.html",
                           "/box.report/poster.webp", "/box.report/report_tiles.jpg"})
    EXPECT_TRUE(exists(out + file)) << file;

  const Outcome inspect = fourdvt("inspect " + out + "/box");
  EXPECT_EQ(inspect.code, 0) << inspect.output;
  EXPECT_NE(inspect.output.find("turn"), std::string::npos);
  EXPECT_NE(inspect.output.find("everything decodes"), std::string::npos);

  const std::string still = out + "/still.png";
  const Outcome render = fourdvt("render " + out + "/box --frame 5 --camera cam02 --no-shadow -o " + still);
  ASSERT_EQ(render.code, 0) << render.output;
  auto ours = platform::readImage(still), matte = platform::readImage(capture + "/turn/mask02/000005.png");
  ASSERT_TRUE(ours.ok() && matte.ok());
  ASSERT_EQ(ours.value().width, 160);
  ASSERT_EQ(ours.value().channels, 4);
  int differing = 0, covered = 0;
  for (int i = 0; i < 160 * 160; ++i) {
    const bool truth = matte.value().pixels[3 * i] >= 128;
    covered += truth;
    differing += truth != (ours.value().pixels[4 * i + 3] >= 128);
  }
  EXPECT_GT(covered, 1000);
  EXPECT_LT(differing, covered / 50);

  const Outcome movie = fourdvt("render " + out + "/box --turntable " + out + "/turn.mp4 --seconds 0.4 --size 96x96");
  EXPECT_EQ(movie.code, 0) << movie.output;
  EXPECT_GT(fs::file_size(out + "/turn.mp4"), 1000u);

  const Outcome score = lab("score " + out + "/box --capture " + capture + " --yardstick -o " + out + "/figures");
  EXPECT_EQ(score.code, 0) << score.output;
  EXPECT_NE(score.output.find("test00"), std::string::npos) << score.output;
  EXPECT_TRUE(exists(out + "/figures/worst.png"));
  // A box turning by 6 degrees a frame, without noise: only codec and blend change its colours, by some levels. On the
  // orbit colours are constant, except for resampling.
  const auto rows = flickerRows(out + "/figures/evaluate.csv");
  EXPECT_EQ(rows.count("turn,cam00"), 1u);
  EXPECT_EQ(rows.at("turn,cam00").size() + 1, 6u) << "of all frames, each against the one before";
  for (const auto& [place, levels] : rows)
    for (double value : levels) EXPECT_TRUE(value > 0.02 && value < 25) << place << " " << value;
  EXPECT_NE(score.output.find("Flicker"), std::string::npos) << score.output;

  const Outcome montage = lab("score " + out + "/box --capture " + capture +
                              " --method montage4d --input-every 0 --flicker 2 -o " + out + "/montage");
  EXPECT_EQ(montage.code, 0) << montage.output;
  const auto with_fields = flickerRows(out + "/montage/evaluate.csv");
  EXPECT_EQ(with_fields.at("turn,cam01").size(), rows.at("turn,cam00").size());
  const Outcome none =
      lab("score " + out + "/box --capture " + capture + " --input-every 0 --flicker 0 -o " + out + "/none");
  EXPECT_EQ(none.output.find("Flicker"), std::string::npos) << none.output;
}

// Expects all renditions in the list, the lowest first. `inspect` decodes every frame of each and checks its barcode.
TEST(Bake, LowerRenditionsLeaveTheHighestAsItIs) {
  const std::string capture = smallCapture("ladder-capture", 6), out = scratch("ladder");
  const std::string options = " --texture 256 --layers 2 --gop 5 --jobs 2 --crf 20";
  const Outcome alone = fourdvt("bake " + capture + " -o " + out + "/alone --renditions highest" + options);
  ASSERT_EQ(alone.code, 0) << alone.output;
  const Outcome bake =
      fourdvt("bake " + capture + " -o " + out + "/box --renditions 256:51:h264,64:30,96:40:av1" + options);
  ASSERT_EQ(bake.code, 0) << bake.output;
  const Outcome inspect = fourdvt("inspect " + out + "/box");
  ASSERT_EQ(inspect.code, 0) << inspect.output;
  EXPECT_NE(inspect.output.find("everything decodes"), std::string::npos) << inspect.output;

  const json gltf = json::parse(readText(out + "/box/character.gltf"));
  const json& turn = gltf["extensions"]["FOURDVT_layered_video_texture"]["sequences"][0];
  ASSERT_EQ(turn["renditions"].size(), 4u);
  const auto path = [&](const std::string& name) { return fileNamed(out + "/box", name); };
  EXPECT_EQ(out + "/box/" + std::string(turn["renditions"][3]["uri"]), path("turn.mp4")) << "the highest";
  uint64_t before = 0;
  std::set<std::string> names;
  for (const json& r : turn["renditions"]) {
    EXPECT_GE(r["byteLength"], before);
    before = r["byteLength"];
    names.insert(r["uri"]);
    EXPECT_EQ(fs::file_size(out + "/box/" + std::string(r["uri"])), before);
  }
  for (const char* name : {"turn.256-51.mp4", "turn.64-30.mp4", "turn.96-40-av1.mp4"})
    EXPECT_EQ(names.count(fs::path(path(name)).filename()), 1u) << name;
  // Expects that the lower renditions change no other file.
  for (const char* file : {"turn.mp4", "mesh.bin", "poster.webp", "texture.jpg"})
    EXPECT_EQ(readText(path(file)), readText(fileNamed(out + "/alone", file))) << file;
  const json before_gltf = json::parse(readText(out + "/alone/character.gltf"));
  const json& stream = before_gltf["extensions"]["FOURDVT_layered_video_texture"]["sequences"][0]["stream"];
  const std::string alone_bytes = readText(fileNamed(out + "/alone", "turn.bin"));
  const auto index =
      package::readStreamHeader({reinterpret_cast<const uint8_t*>(alone_bytes.data()), size_t(stream["headerLength"])});
  ASSERT_TRUE(index.ok()) << index.error().message;
  EXPECT_EQ(index.value().chunks.size(), 2u) << "6 frames, at most 5 in a GOP";
  const std::string chunks = alone_bytes.substr(stream["headerLength"]);
  const std::string with_coarse = readText(path("turn.bin")).substr(turn["stream"]["headerLength"]);
  EXPECT_TRUE(with_coarse.starts_with(chunks)) << "coarse chunks follow them";
  EXPECT_EQ(with_coarse.size(), chunks.size() + turn["stream"]["coarse"]["byteLength"].get<size_t>());
  EXPECT_EQ(turn["stream"]["coarse"]["renditions"], 1);

  const json report = json::parse(readText(out + "/box.report/report.json"));
  EXPECT_EQ(report["sequences"][0]["renditions"].size(), 4u);
  EXPECT_EQ(report["sequences"][0]["video_bytes"], before);
  for (const std::string& name : names) EXPECT_GT(report["bytes_by_part"][name], 100) << name;

  const auto still = [&](const std::string& choice) {
    const Outcome drawn = fourdvt("render " + out + "/box --camera cam02 -o " + out + "/still.png" + choice);
    EXPECT_EQ(drawn.code, 0) << drawn.output;
    return readText(out + "/still.png");
  };
  const std::string highest = still("");
  EXPECT_EQ(still(" --rendition 3"), highest);
  EXPECT_EQ(still(" --rendition 256"), highest);
  EXPECT_NE(still(" --rendition 64"), highest);
  EXPECT_NE(still(" --rendition 0"), highest);
  const Outcome none = fourdvt("render " + out + "/box --rendition 512 -o " + out + "/none.png");
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.output.find("has no rendition 512; --rendition takes 0 ("), std::string::npos) << none.output;
  const auto psnr = [&](const std::string& choice) {
    const Outcome score = lab("score " + out + "/box --capture " + capture + " --input-every 0 --flicker 0" + choice);
    EXPECT_EQ(score.code, 0) << score.output;
    return score.output;
  };
  EXPECT_NE(psnr(" --rendition 64"), psnr(""));
}

TEST(Bake, EveryCodecInspectsAndRenders) {
  const std::string capture = smallCapture("codec-capture", 10), out = scratch("codecs");
  for (const auto& [codec, starts] : {std::pair{"vp9", "vp09.00."}, std::pair{"av1", "av01.0."}}) {
    const std::string box = out + "/" + codec;
    const Outcome bake = fourdvt("bake " + capture + " -o " + box + kSmall + " --codec " + codec);
    ASSERT_EQ(bake.code, 0) << bake.output;
    EXPECT_NE(readText(box + "/character.gltf").find(starts), std::string::npos);
    const Outcome inspect = fourdvt("inspect " + box);
    EXPECT_EQ(inspect.code, 0) << inspect.output;
    EXPECT_NE(inspect.output.find("everything decodes"), std::string::npos) << inspect.output;
    const Outcome render = fourdvt("render " + box + " --frame 7 --camera cam02 -o " + box + ".png");
    EXPECT_EQ(render.code, 0) << render.output;
  }
}

// Paths of all files, relative to the folder.
std::set<std::string> filesIn(const std::string& folder) {
  std::set<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out.insert(fs::relative(entry.path(), folder));
  return out;
}

// All "uri" values anywhere in the JSON.
std::set<std::string> urisIn(const json& value) {
  std::set<std::string> out;
  if (value.is_object() && value.contains("uri")) out.insert(value["uri"].get<std::string>());
  for (const json& part : value)
    if (part.is_structured()) out.merge(urisIn(part));
  return out;
}

TEST(Bake, NamesHoldHashesAndAnotherBakesFilesGo) {
  const std::string capture = smallCapture("named-capture", 4), out = scratch("named"), box = out + "/box";
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + box + kSmall).code, 0);
  const std::set<std::string> first = filesIn(box);
  writeText(box + "/thesis.txt", "years of work");
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + box +
                    " --texture 128 --layers 2 --gop 2 --crf 45 --position-step 0.5 --refine none --refine-cameras off "
                    "--renditions highest")
                .code,
            0);

  const std::set<std::string> uris = urisIn(json::parse(readText(box + "/character.gltf")));
  std::set<std::string> expected = uris;
  expected.insert({"thesis.txt", "character.gltf"});
  EXPECT_EQ(filesIn(box), expected);
  int kept = 0, hashed = 0;
  for (const std::string& uri : uris) {
    kept += first.count(uri) > 0;
    if (uri == "poster.webp" || uri == "character.start.bin") continue;
    ++hashed;
    char digits[11];
    std::snprintf(digits, sizeof digits, ".%08x.", static_cast<unsigned>(fnv1a(readText(box + "/" + uri)) >> 32));
    EXPECT_NE(uri.find(digits), std::string::npos) << uri << " " << digits;
  }
  EXPECT_EQ(hashed, 4) << "video, stream, mesh, texture";
  EXPECT_LT(kept, int(uris.size())) << "the second bake is another one";
  const json report = json::parse(readText(box + ".report/report.json"));
  for (const auto& [file, bytes] : report["bytes_by_part"].items()) EXPECT_EQ(fs::file_size(box + "/" + file), bytes);
  EXPECT_EQ(fourdvt("inspect " + box).code, 0);
}

// Readers use the manifest's file names.
TEST(Bake, CharactersOfEarlierNamesAreRead) {
  const std::string capture = smallCapture("renamed-capture", 4), out = scratch("renamed"), box = out + "/box";
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + box + kSmall).code, 0);
  std::string gltf = readText(box + "/character.gltf");
  for (const std::string name : {"turn.mp4", "turn.bin", "mesh.bin", "texture.jpg"}) {
    const std::string hashed = fs::path(fileNamed(box, name)).filename();
    ASSERT_NE(hashed, name);
    for (size_t at; (at = gltf.find('"' + hashed + '"')) != std::string::npos;)
      gltf.replace(at + 1, hashed.size(), name);
    fs::rename(box + "/" + hashed, box + "/" + name);
  }
  writeText(box + "/character.gltf", gltf);
  const Outcome inspect = fourdvt("inspect " + box);
  EXPECT_EQ(inspect.code, 0) << inspect.output;
  EXPECT_NE(inspect.output.find("everything decodes"), std::string::npos) << inspect.output;
  const Outcome render = fourdvt("render " + box + " --frame 2 -o " + out + "/still.png");
  EXPECT_EQ(render.code, 0) << render.output;
}

// Explicit options override the quality's.
TEST(Bake, QualityIsOverriddenByOptions) {
  const std::string capture = smallCapture("quality-capture", 2), out = scratch("quality");
  const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box --quality draft --texture 128 --equal-layers");
  ASSERT_EQ(bake.code, 0) << bake.output;
  const Outcome inspect = fourdvt("inspect " + out + "/box");
  // Quality draft has three layers: squares of 128 side by side, and a barcode 512 wide below.
  EXPECT_NE(inspect.output.find("512x144"), std::string::npos) << inspect.output;
  // The standard ladder below it: at most half the texels a side, and the same size at a coarser CRF than draft's 37.
  EXPECT_NE(inspect.output.find("512x80"), std::string::npos) << inspect.output;
  for (const char* file : {"turn.mp4", "turn.128-44.mp4", "turn.64-42.mp4"})
    EXPECT_TRUE(exists(fileNamed(out + "/box", file))) << file;
}

TEST(Bake, InterruptedResumesToTheSameBytes) {
  const std::string capture = smallCapture("long-capture", 32), out = scratch("resume");
  const std::string options = " --texture 128 --layers 2 --gop 4 --jobs 2 --renditions 128:40,64:36 --sequences turn";
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + out + "/straight" + options).code, 0);

  const std::string stopped = out + "/stopped";
  const Outcome stop = interrupted(FOURDVT_BIN, "bake " + capture + " -o " + stopped + options,
                                   stopped + ".work/turn.0.gop", out + "/log");
  ASSERT_EQ(stop.code, 130) << stop.output;
  EXPECT_FALSE(exists(stopped));
  EXPECT_NE(stop.output.find("--resume"), std::string::npos);

  const Outcome resumed = fourdvt("bake " + capture + " -o " + stopped + options + " --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_NE(readText(stopped + ".report/report.json").find("\"resumed\": true"), std::string::npos);
  EXPECT_EQ(differences(out + "/straight", stopped), std::vector<std::string>{});
}

TEST(Bake, OutputThatCannotBeWritten) {
  const std::string capture = smallCapture("unwritable-capture", 2), out = scratch("unwritable");
  writeText(out + "/file", "not a folder");
  for (const std::string& target : {out + "/file/box", std::string("/proc/fourdvt/box")})
    expectFailure(fourdvt("bake " + capture + " -o " + target + kSmall), target, target);
  writeText(out + "/notes.txt", "somebody's work");
  EXPECT_EQ(fourdvt("bake " + capture + " -o " + out + kSmall).code, 1);  // a folder that is not a character
  EXPECT_EQ(readText(out + "/notes.txt"), "somebody's work");
}

TEST(Bake, FullDiskIsNamedBeforeTheWork) {
  const std::string capture = smallCapture("full-capture", 2), mount = scratch("full");
  if (shell("mount -t tmpfs -o size=1m none " + mount).code != 0) GTEST_SKIP() << "needs the right to mount a tmpfs";
  const Outcome outcome = fourdvt("bake " + capture + " -o " + mount + "/box" + kSmall);
  const bool left = exists(mount + "/box");
  EXPECT_EQ(shell("umount " + mount).code, 0);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(isOneLineWith(outcome, "free")) << outcome.output;
  EXPECT_FALSE(left);
}

TEST(Bake, WriteThatFailsHalfWayLeavesNoCharacter) {
  const std::string capture = smallCapture("limited-capture", 8), out = scratch("limited");
  // Files may not grow beyond 4 blocks of 512 bytes (dash) or 1 KiB (bash); the ignored signal turns it into an error.
  const Outcome outcome = shell("trap '' XFSZ; ulimit -f 4; " + std::string(FOURDVT_BIN) + " bake " + capture + " -o " +
                                out + "/box" + kSmall);
  expectFailure(outcome, out + "/box", out + "/box");
}

class WrongCapture : public testing::Test {
 protected:
  void SetUp() override {
    capture = smallCapture("wrong-capture", 3);
    character = scratch("wrong") + "/box";
  }
  void expectNamed(const std::string& file) {
    expectFailure(fourdvt("bake " + capture + " -o " + character + kSmall), file, character);
  }
  std::string capture, character;
};

// Returns a WAV file of 16-bit silence with a click at its beginning.
std::string silentWav(double seconds) {
  const auto number = [](uint32_t v, int bytes) {
    std::string out;
    for (int b = 0; b < bytes; ++b) out += char(v >> (8 * b) & 255);
    return out;
  };
  std::string data(2 * size_t(seconds * 8000), char(0));
  data[1] = 64;
  return "RIFF" + number(36 + uint32_t(data.size()), 4) + "WAVEfmt " + number(16, 4) + number(1, 2) + number(1, 2) +
         number(8000, 4) + number(16000, 4) + number(2, 2) + number(16, 2) + "data" + number(uint32_t(data.size()), 4) +
         data;
}

void declareSound(const std::string& capture, const json& sound) {
  json j = json::parse(readText(capture + "/capture.json"));
  j["sequences"][0]["audio"] = sound;
  writeText(capture + "/capture.json", j.dump());
}

TEST(Bake, SoundLiesBesideTheVideosAndInspectChecksIt) {
  const std::string capture = smallCapture("sound-capture", 4), out = scratch("sound"), box = out + "/box";
  writeText(capture + "/turn/sound.wav", silentWav(0.05));
  declareSound(capture, "turn/sound.wav");
  const Outcome bake = fourdvt("bake " + capture + " -o " + box + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_NE(readText(box + ".report/report.json").find("the sound of 'turn' ends after 0.05 s of 0.16 s"),
            std::string::npos);
  const Outcome inspect = fourdvt("inspect " + box);
  EXPECT_EQ(inspect.code, 0);
  EXPECT_NE(inspect.output.find("sound of turn: mono, 1 segments of 0.16 s"), std::string::npos) << inspect.output;
  std::string damaged;
  for (const std::string& name : filesIn(box))
    if (name.ends_with(".webm")) damaged = box + "/" + name;
  ASSERT_FALSE(damaged.empty());
  std::string bytes = readText(damaged);
  bytes.back() ^= 1;
  writeText(damaged, bytes);
  const Outcome refused = fourdvt("inspect " + box);
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.output.find(damaged + ": its bytes are not those that were baked"), std::string::npos)
      << refused.output;

  declareSound(capture, nullptr);
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + box + kSmall).code, 0);
  EXPECT_FALSE(exists(damaged)) << "the sound of the bake before has gone";
}

TEST_F(WrongCapture, SoundThatCannotBeHeard) {
  declareSound(capture, "turn/none.wav");
  expectNamed(capture + "/turn/none.wav");
  writeText(capture + "/turn/sound.wav", silentWav(0.5));
  declareSound(capture, {{"file", "turn/sound.wav"}, {"offset_ms", 60000}});
  expectNamed("nothing of " + capture + "/turn/sound.wav is heard in \"turn\": correct \"offset_ms\"");
  declareSound(capture, {{"file", "turn/sound.wav"}, {"offset_ms", -600}});
  expectNamed("nothing of " + capture + "/turn/sound.wav is heard");
  declareSound(capture, "capture.json");
  expectNamed(capture + "/capture.json: its sound cannot be decoded");
  declareSound(capture, "../sound.wav");
  expectNamed("leads out of the capture folder");
}

TEST_F(WrongCapture, ReportFolderOfSomebodyElse) {
  fs::create_directories(character + ".report");
  writeText(character + ".report/thesis.txt", "years of work");
  expectNamed(character + ".report: exists and is not only a bake's report");
  EXPECT_EQ(readText(character + ".report/thesis.txt"), "years of work");
}

TEST_F(WrongCapture, NoCaptureJson) {
  fs::remove(capture + "/capture.json");
  expectNamed(capture + "/capture.json");
}

TEST_F(WrongCapture, UnparsableCaptureJson) {
  truncateTo(capture + "/capture.json", 0.5);
  expectNamed(capture + "/capture.json");
}

TEST_F(WrongCapture, CameraWithoutPictures) {
  fs::remove_all(capture + "/turn/cam02");
  expectNamed("turn/cam02");
}

TEST_F(WrongCapture, TooFewPictures) {
  fs::remove(capture + "/turn/cam01/000002.png");
  expectNamed("turn/cam01");
}

TEST_F(WrongCapture, PictureOfAnotherSize) {
  ASSERT_TRUE(platform::writeImage(capture + "/turn/cam03/000001.png", Image(100, 160, 3)).ok());
  expectNamed("turn/cam03/");
}

TEST_F(WrongCapture, BrokenPicture) {
  truncateTo(capture + "/turn/cam03/000000.png", 0.3);
  expectNamed("turn/cam03/");
}

TEST_F(WrongCapture, UnknownCameraModel) {
  ASSERT_EQ(shell("sed -i 's/PINHOLE/FOV/' " + capture + "/cameras/cameras.txt").code, 0);
  expectNamed("cameras/cameras.txt");
}

TEST_F(WrongCapture, OtherTopologyInALaterFrame) {
  ASSERT_EQ(shell("sed -i '$d' " + capture + "/turn/mesh/000002.obj").code, 0);
  expectNamed("turn/mesh/000002.obj");
}

TEST_F(WrongCapture, NoMeshes) {
  fs::remove_all(capture + "/turn/mesh");
  expectNamed(capture +
              "/capture.json: the capture has no meshes; run `fourdvt reconstruct CAPTURE -o CAPTURE2` first");
}

TEST_F(WrongCapture, MeshesOfPerFrameTopology) {
  ASSERT_EQ(shell("sed -i '0,/{/s//{\"topology\": \"per-frame\", /' " + capture + "/capture.json").code, 0);
  const Outcome bake = fourdvt("bake " + capture + " -o " + character + kSmall + " --appearance layers");
  expectFailure(bake, capture + "/capture.json: the meshes are of \"per-frame\" topology", character);
  EXPECT_NE(bake.output.find("bake with --appearance cameras"), std::string::npos) << bake.output;
}

TEST_F(WrongCapture, NothingVisibleNamesAxesAndUnits) {
  // Unit millimetre instead of metre: every camera is inside the box.
  ASSERT_EQ(
      shell("sed -i -E 's/^v ([^ ]+) ([^ ]+) ([^ ]+)$/v \\1e3 \\2e3 \\3e3/' " + capture + "/turn/mesh/*.obj").code, 0);
  expectNamed("units");
}

TEST_F(WrongCapture, RenditionsOfTheWrongKind) {
  const std::string layers = " --texture 128 --layers 2 --renditions 0.5:30";
  expectFailure(fourdvt("bake " + capture + " -o " + character + layers), "texels of layer 1", character);
}

TEST_F(WrongCapture, RenditionWithTheNameOfAnotherSequence) {
  json j = json::parse(readText(capture + "/capture.json"));
  j["sequences"].push_back(j["sequences"][0]);
  j["sequences"].back()["name"] = "turn.64-30";
  writeText(capture + "/capture.json", j.dump());
  fs::copy(capture + "/turn", capture + "/turn.64-30", fs::copy_options::recursive);
  expectFailure(fourdvt("bake " + capture + " -o " + character + " --texture 128 --renditions 64:30"),
                "'turn.64-30' is also the name of a rendition of 'turn'", character);
}

}  // namespace
}  // namespace fourdvt::test
