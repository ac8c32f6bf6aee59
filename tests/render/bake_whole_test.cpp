// SPDX-License-Identifier: Apache-2.0
// The whole bake on a small capture: its output, stopping and resuming, invalid output folders.
#include <sys/resource.h>

#include <algorithm>
#include <csignal>

#include "../unit/capture_fixture.h"
#include "../unit/character_files.h"
#include "bake/bake.h"
#include "bake_environment.h"
#include "edge/character_player.h"
#include "gl_fixture.h"
#include "lab/labels/paper_labellings.h"
#include "lab/measure/held_out.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"
#include "platform/ffmpeg_video.h"
#include "render/passes.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

struct WholeBake : testing::GlFixture {
  capture::SmallCapture input;
  std::atomic<bool> stop{false};
  std::vector<std::string> stages;  // of the last run
  std::string stop_at;              // stage; empty: none
  BakeOptions options;

  void SetUp() override {
    GlFixture::SetUp();
    // Two cameras 3 m in front of the quad, side by side.
    input.write("cameras/images.txt",
                std::string("1 0 1 0 0 -0.5 0.5 3 1 cam00.png\n\n2 0 1 0 0 -0.7 0.5 3 1 cam01.png\n\n"));
    options.capture_folder = input.path();
    options.character_folder = input / "out/character";
    options.layers = 2;
    options.texture = 128;
    options.gop = 2;
  }

  Result<BakeReport> run(uint32_t stop_after = 1000) {
    stop = false;
    stages.clear();
    return bake(options, testEnvironment(*device, stop, [&](const FrameProgress& p) {
                  stages.push_back(p.stage);
                  stop = p.done >= stop_after || p.stage == stop_at;
                }));
  }
  std::string bytesOf(const std::string& name) {
    auto bytes = platform::readFile(fileNamed(options.character_folder, name));
    return bytes ? std::string(bytes.value().begin(), bytes.value().end()) : "absent: " + name;
  }
  // Expects no files beside or in place of the character.
  void expectNothingWritten() {
    EXPECT_FALSE(fs::exists(options.character_folder));
    EXPECT_FALSE(fs::exists(options.character_folder + ".work"));
  }
};

TEST_F(WholeBake, WritesACharacterThatReadsBack) {
  auto report = run();
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report.value().frames, 3u);
  auto json = platform::readJsonFlat(options.character_folder + "/character.gltf");
  ASSERT_TRUE(json) << json.error().message;
  auto character = package::readManifest(json.value());
  ASSERT_TRUE(character) << character.error().message;
  ASSERT_EQ(character.value().sequences.size(), 1u);
  auto mesh = package::decodeBaseMesh(platform::readFile(fileNamed(options.character_folder, "mesh.bin")).take());
  ASSERT_TRUE(mesh);
  const package::ChunkMesh chunk_mesh = package::makeChunkMesh(mesh.value());
  const package::Sequence& walk = character.value().sequences[0];
  auto stream = platform::readFile(options.character_folder + "/" + walk.stream_uri);
  ASSERT_TRUE(stream);
  const std::span<const uint8_t> bytes(stream.value());
  auto index = package::readStreamHeader(bytes.first(walk.stream_header_bytes));
  ASSERT_TRUE(index) << index.error().message;
  ASSERT_EQ(index.value().chunks.size(), 2u);
  for (uint32_t g = 0; g < 2; ++g) {
    const package::ChunkEntry& entry = index.value().chunks[g];
    auto chunk = package::decodeChunk(bytes.subspan(entry.offset, entry.bytes), index.value(), g, chunk_mesh);
    ASSERT_TRUE(chunk) << chunk.error().message;
    for (uint8_t label : chunk.value().labels) EXPECT_LT(label, 2) << "both cameras see both faces";
    // The quad moves away by 0.1 m a frame.
    const glm::ivec3 q = chunk.value().positions[0];
    EXPECT_NEAR(index.value().position_origin.z + index.value().position_step_m * q.z, 0.1 * entry.first_frame, 1.3e-4);
  }
  for (const char* name : {"poster.webp", "texture.jpg", "mesh.bin"})
    EXPECT_TRUE(fs::exists(fileNamed(options.character_folder, name))) << name;
  for (const char* name : {"report.json", "report.html", "poster.webp"})
    EXPECT_TRUE(fs::exists(reportFolderOf(options.character_folder) + "/" + name)) << name;
  EXPECT_FALSE(fs::exists(options.character_folder + ".work"));
}

// Values that the player passes to a picture's passes.
struct Told {
  float elapsed_s = 0;
  uint64_t geometry = 0;
  glm::vec3 eye{0};
};
class TellingPass : public render::LayeredPass {
 public:
  Status prepare(gpu::Device& device, const render::CharacterModel& model, const render::Part& part,
                 const render::CharacterView& view, const render::DrawOptions& options) override {
    pictures.push_back({options.method.elapsed_s, model.geometry_serial, view.eye_in_character});
    return LayeredPass::prepare(device, model, part, view, options);
  }
  std::vector<Told> pictures;
};

TEST_F(WholeBake, FlickerIsOfFramesInOrderAFramePeriodApart) {
  ASSERT_TRUE(run());
  auto player = edge::CharacterPlayer::open(*device, options.character_folder).take();
  const auto told = std::make_shared<TellingPass>();
  player->recipe().setLayered(told);
  const auto capture = input.open().take();
  const auto report =
      measure::evaluateHeldOut(capture, platform::openVideoFile, *player, {.input_every = 0, .flicker_cameras = 2});
  ASSERT_TRUE(report) << report.error().message;
  constexpr size_t kFrames = capture::SmallCapture::kFrames, kOrbit = measure::kOrbitPictures;
  ASSERT_EQ(told->pictures.size(), 2 * kFrames + kOrbit);
  for (size_t i = 0; i < told->pictures.size(); ++i) {
    const Told& now = told->pictures[i];
    const bool on_orbit = i >= 2 * kFrames;
    if (i == 0 || i == kFrames || i == 2 * kFrames) {
      EXPECT_TRUE(std::isinf(now.elapsed_s)) << i << ": nothing went before";
      continue;
    }
    const Told& before = told->pictures[i - 1];
    EXPECT_FLOAT_EQ(now.elapsed_s, 1 / 25.0f) << i;
    EXPECT_EQ(now.geometry != before.geometry, !on_orbit) << i;
    EXPECT_EQ(now.eye != before.eye, on_orbit) << i;
  }
  const auto& flicker = report.value().flicker;
  ASSERT_EQ(flicker.size(), 2 * (kFrames - 1) + kOrbit - 1);
  EXPECT_EQ(flicker[1].camera, "cam00");
  EXPECT_EQ(flicker[1].frame, 2u);
  EXPECT_EQ(flicker[2].camera, "cam01");
  EXPECT_EQ(flicker.back().camera, measure::kOrbit);
  EXPECT_EQ(flicker.back().frame, kOrbit - 1);
}

TEST_F(WholeBake, ResumedBakeGivesTheSameBytes) {
  ASSERT_TRUE(run());
  const std::vector<std::string> names{"walk.mp4",       "walk.bin",    "mesh.bin",
                                       "character.gltf", "texture.jpg", "poster.webp"};
  std::vector<std::string> whole;
  for (const std::string& name : names) whole.push_back(bytesOf(name));
  fs::remove_all(options.character_folder);

  auto stopped = run(2);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().id, ErrorId::Interrupted);
  EXPECT_NE(stopped.error().message.find("--resume"), std::string::npos);
  EXPECT_FALSE(fs::exists(options.character_folder));
  EXPECT_NE(workFile(options.character_folder + ".work", "walk.0.gop"), "");
  options.resume = true;
  options.jobs = 1;  // other threads, same bytes
  auto resumed = run();
  ASSERT_TRUE(resumed) << resumed.error().message;
  for (size_t i = 0; i < names.size(); ++i) EXPECT_TRUE(bytesOf(names[i]) == whole[i]) << names[i];
}

TEST_F(WholeBake, StopOnTheLastFrameOfAGopKeepsIt) {
  options.jobs = 1;
  ASSERT_FALSE(run(1));  // GOP 0 contains only frame 0
  EXPECT_NE(workFile(options.character_folder + ".work", "walk.0.gop"), "");
}

TEST_F(WholeBake, StopInTheSurveyKeepsWhatWasMeasured) {
  options.jobs = 1;
  stop_at = "survey walk 2/3";
  auto stopped = run();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().id, ErrorId::Interrupted);
  EXPECT_NE(stopped.error().message.find("--resume"), std::string::npos);
  stop_at.clear();
  options.resume = true;
  options.colour_calibration = false;  // else its frames would be read again
  ASSERT_FALSE(run(1)) << "other settings: measured again";
  EXPECT_EQ(stages.front(), "survey walk 1/3");
  ASSERT_TRUE(run());
  EXPECT_TRUE(std::none_of(stages.begin(), stages.end(), [](const std::string& s) { return s.find("survey") == 0; }));
}

TEST_F(WholeBake, TheSurveyDoesNotDependOnItsWindows) {
  ASSERT_TRUE(run());
  const std::vector<std::string> names{"walk.mp4", "walk.bin", "character.gltf"};
  std::vector<std::string> whole;
  for (const std::string& name : names) whole.push_back(bytesOf(name));
  fs::remove_all(options.character_folder);
  // Stops in the first of two windows, then in the second, then finishes.
  options.survey_window_frames = 2;
  options.resume = true;
  for (const char* at : {"survey walk 1/3", "survey walk 3/3"}) {
    stop_at = at;
    ASSERT_FALSE(run());
  }
  stop_at.clear();
  ASSERT_TRUE(run());
  EXPECT_TRUE(std::none_of(stages.begin(), stages.end(), [](const std::string& s) { return s.find("survey") == 0; }));
  for (size_t i = 0; i < names.size(); ++i) EXPECT_TRUE(bytesOf(names[i]) == whole[i]) << names[i];
}

TEST_F(WholeBake, SurveyFolderIsSharedBetweenBakes) {
  options.survey_folder = input / "out/survey";
  ASSERT_TRUE(run());
  const std::string before = bytesOf("walk.mp4");
  options.crf = 40;
  ASSERT_TRUE(run());
  EXPECT_EQ(stages.front(), "walk 1/3") << "measured again";
  EXPECT_NE(bytesOf("walk.mp4"), before);
  EXPECT_TRUE(fs::exists(options.survey_folder));
}

TEST_F(WholeBake, EveryLabellingBakes) {
  for (const Labelling* rule : lab::allLabellings()) {
    lab::useLabelling(*rule, options);
    auto report = run();
    ASSERT_TRUE(report) << rule->name << ": " << report.error().message;
    ASSERT_EQ(report.value().labels_by_sequence.count("walk"), 1u);
    EXPECT_EQ(report.value().labels_by_sequence["walk"].frames, 3u) << rule->name;
  }
}

TEST_F(WholeBake, OtherSettingsDoNotResume) {
  ASSERT_FALSE(run(2));
  options.resume = true;
  options.crf = 40;
  uint32_t first_done = 0;
  BakeEnvironment environment;
  environment.device = device.get();
  environment.open_video = platform::openVideoFile;
  environment.progress = [&](const FrameProgress& p) { first_done = first_done ? first_done : p.done; };
  ASSERT_TRUE(bake(options, environment));
  EXPECT_EQ(first_done, 1u) << "a GOP of other settings was reused";
}

TEST_F(WholeBake, CamerasBehindTheMeshSayAxesOrUnits) {
  input.write("cameras/images.txt", std::string("1 1 0 0 0 -0.5 0 3 1 cam00.png\n\n2 1 0 0 0 0 0 3 1 cam01.png\n\n"));
  auto report = run();
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().id, ErrorId::NothingVisible);
  EXPECT_NE(report.error().message.find("axes and units"), std::string::npos) << report.error().message;
  expectNothingWritten();
}

TEST_F(WholeBake, ForeignFolderIsRefusedAndKept) {
  input.write("out/character/thesis.txt", std::string("years of work"));
  auto report = run();
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(bytesOf("thesis.txt"), "years of work");
}

TEST_F(WholeBake, FolderThatCannotBeCreatedIsWriteFailed) {
  input.write("out", std::string("a file, not a folder"));
  auto report = run();
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().id, ErrorId::WriteFailed) << report.error().message;
  EXPECT_NE(report.error().message.find("out/character"), std::string::npos) << report.error().message;
}

TEST_F(WholeBake, FullDiskLeavesThePreviousCharacter) {
  ASSERT_TRUE(run());
  const std::string before = bytesOf("walk.bin");
  options.crf = 18;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = 4096;  // limits file sizes, like a full disk
  setrlimit(RLIMIT_FSIZE, &small);
  auto report = run();
  setrlimit(RLIMIT_FSIZE, &old);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().id, ErrorId::WriteFailed) << report.error().message;
  EXPECT_TRUE(bytesOf("walk.bin") == before);
}

}  // namespace
}  // namespace fourdvt::bake
