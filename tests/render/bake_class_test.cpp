// SPDX-License-Identifier: Apache-2.0
// Bakes a motion class: two loops of different length on common time, one starting at another phase of its cycle.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>

#include "../unit/capture_fixture.h"
#include "../unit/character_files.h"
#include "bake/bake.h"
#include "bake/motion/class_plan.h"
#include "bake/run/options.h"
#include "bake/stages/stages.h"
#include "bake_environment.h"
#include "gl_fixture.h"
#include "package/barcode.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

constexpr int kWalkFrames = 9, kRunFrames = 6;

// Flag of 5 × 3 vertices that stands on the ground and waves; `turn`: share of the cycle.
std::string flagObj(double turn) {
  std::string text;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      const double wave = 0.1 * y * std::sin(2 * 3.14159265358979 * turn + x);
      text += "v " + std::to_string(0.25 * x) + " " + std::to_string(0.5 * y) + " " + std::to_string(wave) + "\nvt " +
              std::to_string(0.05 + 0.225 * x) + " " + std::to_string(0.05 + 0.45 * y) + "\n";
    }
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      std::string face = "f";
      for (int corner : {0, 1, 6, 5}) {
        const std::string index = std::to_string(5 * y + x + corner + 1);
        face += " " + index + "/" + index;
      }
      text += face + "\n";
    }
  return text;
}

// Class of two loops: walk begins at 0 of the cycle, run at 0.4 of it, so that common time wraps one of them. In every
// camera, frame k of walk has grey 40 + 20 k, of run grey 60 + 30 k.
struct ClassCapture : capture::SmallCapture {
  ClassCapture() {
    write("cameras/images.txt",
          std::string("1 0 1 0 0 -0.5 0.5 3 1 cam00.png\n\n2 0 1 0 0 -0.7 0.5 3 1 cam01.png\n\n"));
    setFrames(kWalkFrames, kRunFrames);
  }
  void setFrames(int walk_frames, int run_frames) {
    walk = walk_frames;
    run = run_frames;
    remove("walk");
    remove("run");
    addLoop("walk", walk, 0, 40, 20);
    addLoop("run", run, 0.4, 60, 30);
    declare(R"([{"name": "go", "parameter": "speed_mps", "members": ["walk", "run"]}])");
  }
  void addLoop(const std::string& name, int frames, double begin, int grey_first, int grey_step) const {
    for (int f = 0; f < frames; ++f) {
      for (int camera = 0; camera < kCameras; ++camera) {
        const std::string number = std::to_string(camera);
        write(name + "/cam0" + number + "/" + capture::numbered(f, ".png"), grey(grey_first + grey_step * f));
        write(name + "/mask0" + number + "/" + capture::numbered(f, ".png"), capture::framedMatte(kWidth, kHeight));
      }
      write(name + "/mesh/" + capture::numbered(f, ".obj"), flagObj(begin + double(f) / frames));
    }
  }
  void declare(const std::string& classes) const {
    const auto loop = [](const char* name, int frames, int speed) {
      return "{\"name\": \"" + std::string(name) + "\", \"frames\": " + std::to_string(frames) +
             ", \"loop\": true, \"root_velocity\": [0, 0, " + std::to_string(speed) + "]}";
    };
    write("capture.json", "{\"fps\": 25, \"units\": \"metre\", \"sequences\": [" + loop("walk", walk, 1) + ", " +
                              loop("run", run, 3) + "], \"classes\": " + classes + "}");
  }
  int walk = 0, run = 0;  // frames
};

struct Stream {
  package::Sequence sequence;
  package::StreamIndex index;
  std::vector<package::ChunkFrames> chunks;
};

struct BakeClass : testing::GlFixture {
  ClassCapture input;
  std::atomic<bool> stop{false};
  std::vector<std::string> stages;
  std::string stop_at;               // stage to stop at; empty: none
  std::function<void()> when_there;  // instead of stopping
  BakeOptions options;

  void SetUp() override {
    GlFixture::SetUp();
    options.capture_folder = input.path();
    options.character_folder = input / "out/character";
    options.layers = 2;
    options.texture = 128;
    options.gop = 5;
    options.crf = 8;
    options.colour_calibration = false;
    options.classes.align = false;
  }
  Result<BakeReport> run() {
    stop = false;
    stages.clear();
    return bake(options, testEnvironment(*device, stop, [&](const FrameProgress& p) {
                  stages.push_back(p.stage);
                  if (p.stage != stop_at) return;
                  when_there ? when_there() : void(stop = true);
                }));
  }
  std::vector<uint8_t> bytesOf(const std::string& name) {
    auto bytes = platform::readFile(fileNamed(options.character_folder, name));
    EXPECT_TRUE(bytes) << name;
    return bytes ? bytes.take() : std::vector<uint8_t>();
  }
  package::Character character() {
    auto json = platform::readJsonFlat(options.character_folder + "/character.gltf");
    EXPECT_TRUE(json);
    auto character = package::readManifest(json.value());
    EXPECT_TRUE(character) << (character ? "" : character.error().message);
    return character ? character.take() : package::Character();
  }
  Stream stream(const std::string& name) {
    Stream out;
    out.sequence = *character().find(name);
    const std::vector<uint8_t> file = bytesOf(out.sequence.stream_uri);
    const std::span<const uint8_t> bytes(file);
    auto index = package::readStreamHeader(bytes.first(out.sequence.stream_header_bytes));
    EXPECT_TRUE(index) << (index ? "" : index.error().message);
    out.index = index.take();
    const package::ChunkMesh mesh = package::makeChunkMesh(package::decodeBaseMesh(bytesOf("mesh.bin")).value());
    for (uint32_t g = 0; g < out.index.chunks.size(); ++g) {
      const package::ChunkEntry& entry = out.index.chunks[g];
      auto chunk = package::decodeChunk(bytes.subspan(entry.offset, entry.bytes), out.index, g, mesh);
      EXPECT_TRUE(chunk) << (chunk ? "" : chunk.error().message);
      out.chunks.push_back(chunk.take());
    }
    return out;
  }
  // Plan equal to the bake's, in the capture's own order of vertices.
  ClassPlan plan(const capture::Capture& capture) {
    const ReadPositions read = [&](const capture::CaptureSequence& sequence, uint32_t frame) {
      return capture::readMeshFrame(capture, sequence, frame);
    };
    auto plan = planClass(capture, capture.classes[0], {capture.topology, read}, {}, [](double) { return true; });
    EXPECT_TRUE(plan) << (plan ? "" : plan.error().message);
    return plan.take();
  }
  void expectResumes(std::initializer_list<const char*> stop_stages);
  void expectError(ErrorId id, const std::string& part) {
    auto report = run();
    ASSERT_FALSE(report);
    EXPECT_EQ(errorName(report.error().id), std::string(errorName(id)));
    EXPECT_NE(report.error().message.find(part), std::string::npos) << report.error().message;
    EXPECT_FALSE(fs::exists(options.character_folder));
    EXPECT_FALSE(fs::exists(options.character_folder + ".work"));
  }
};

TEST_F(BakeClass, ManifestTellsTheClass) {
  auto report = run();
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report.value().frames, uint32_t(kWalkFrames + kRunFrames + kWalkFrames));
  const package::Character c = character();
  ASSERT_EQ(c.sequences.size(), 3u);
  EXPECT_EQ(c.sequences[0].members.size(), 1u);
  EXPECT_NEAR(c.sequences[1].members[0].duration_s, kRunFrames / 25.0, 1e-9);
  EXPECT_NEAR(c.sequences[1].members[0].travel.y, 3 * kRunFrames / 25.0, 1e-6);
  const package::Sequence& go = c.sequences[2];
  EXPECT_EQ(go.name, "go");
  EXPECT_TRUE(go.loop);
  EXPECT_EQ(go.frame_count, uint32_t(kWalkFrames));
  EXPECT_NEAR(go.fps, kWalkFrames / (0.5 * (kWalkFrames + kRunFrames) / 25), 1e-6);
  ASSERT_EQ(go.members.size(), 2u);
  EXPECT_EQ(go.members[1].name, "run");
  ASSERT_EQ(go.space.names, std::vector<std::string>{"speed_mps"});
  EXPECT_EQ(go.renditions[0].layers.size(), 4u);
  EXPECT_FALSE(c.graph_uri.empty());
  EXPECT_EQ(c.graph_bytes, bytesOf(c.graph_uri).size());
  ASSERT_EQ(report.value().classes.count("go"), 1u);
  EXPECT_EQ(report.value().classes["go"].references, go.reference_count);
  EXPECT_LE(report.value().classes["go"].hybrid_error_m, c.length_scale * kBlendError_m);
  EXPECT_EQ(stages.front().rfind("refine ", 0), 0u) << stages.front();
  const auto next =
      std::find_if(stages.begin(), stages.end(), [](const auto& s) { return s.rfind("refine ", 0) != 0; });
  ASSERT_NE(next, stages.end());
  EXPECT_EQ(next->rfind("warp go", 0), 0u) << *next;
}

TEST_F(BakeClass, StreamHoldsMembersAtTheirPhases) {
  ASSERT_TRUE(run());
  const Stream go = stream("go");
  ASSERT_EQ(go.index.member_count, 2u);
  EXPECT_EQ(go.index.alignment_count, 0u);
  auto opened = input.open();
  ASSERT_TRUE(opened);
  const ClassPlan truth = plan(opened.value());
  bool wraps = false;
  for (const package::ChunkFrames& chunk : go.chunks)
    for (uint32_t row = 0; row < chunk.frame_count; ++row) {
      const uint32_t phase = go.index.chunks[&chunk - go.chunks.data()].first_frame + row;
      for (size_t m = 0; m < 2; ++m) {
        const int frames = m ? kRunFrames : kWalkFrames;
        const double at = truth.members[m].source_frame[phase], turn = (m ? 0.4 : 0) + at / frames;
        wraps |= at >= frames;
        for (uint32_t v = 0; v < go.index.vertex_count; ++v) {
          const glm::vec3 p =
              go.index.position_origin +
              go.index.position_step_m * glm::vec3(chunk.positions[(row * 2 + m) * go.index.vertex_count + v]);
          // Four-point interpolation of a sine, sampled at sixths of its cycle.
          const double wave = 0.2 * p.y * std::sin(2 * 3.14159265358979 * turn + p.x / 0.25);
          ASSERT_NEAR(p.z, wave, 0.006) << "member " << m << " phase " << phase << " vertex " << v;
        }
        EXPECT_NEAR(chunk.root[row * 2 + m].y, truth.members[m].root[phase].y, 1e-5);
      }
    }
  EXPECT_TRUE(wraps) << "the capture does not test the wrap";
}

// Expects in every decoded picture of every rendition the barcode of its phase, and in each member's layer 1 the grey
// of the nearest captured frame.
TEST_F(BakeClass, VideosTileTheNearestCapturedFrames) {
  options.lower_renditions = {{128, 12, encode::Codec::H264, "veryfast"}, {64, 10, encode::Codec::H264, ""}};
  ASSERT_TRUE(run());
  const Stream go = stream("go");
  auto opened = input.open();
  ASSERT_TRUE(opened);
  const ClassPlan truth = plan(opened.value());
  ASSERT_EQ(go.sequence.renditions.size(), 3u);
  for (size_t r = 0; r < 3; ++r) {
    const package::Rendition& rendition = go.sequence.renditions[r];
    EXPECT_EQ(rendition.layers[0].width, r == 0 ? 64 : 128);
    if (r > 0) {
      EXPECT_GE(rendition.video_bytes, go.sequence.renditions[r - 1].video_bytes);
    }
    const std::vector<uint8_t> video = bytesOf(rendition.video_uri);
    uint32_t shown = 0;
    auto decoder = platform::SampleDecoder::create(
        rendition.codec, go.index.renditions[r].decoder_description, [&](const I420View& view, int64_t phase) {
          EXPECT_EQ(package::readBarcode(rendition.barcode, view).value_or(9999), uint32_t(phase));
          for (size_t m = 0; m < 2; ++m) {
            const int frames = m ? kRunFrames : kWalkFrames;
            const int source = int(std::lround(truth.members[m].source_frame[phase])) % frames;
            const int grey = m ? 60 + 30 * source : 40 + 20 * source;
            const package::Rect& rect = rendition.layers[2 * m];
            const int luma = view.y[(rect.y + rect.height / 2) * view.stride_y + rect.x + rect.width / 2];
            EXPECT_NEAR(luma, 16 + grey * 219 / 255.0, 3) << "member " << m << " phase " << phase << " of " << r;
          }
          ++shown;
        });
    ASSERT_TRUE(decoder);
    for (const package::VideoSample& s : go.index.renditions[r].samples)
      ASSERT_TRUE(decoder.value()->decode(std::span(video).subspan(s.offset, s.bytes), s.frame, s.key).ok());
    ASSERT_TRUE(decoder.value()->flush().ok());
    EXPECT_EQ(shown, uint32_t(kWalkFrames));
  }
}

// Stops at each named stage in turn and resumes with another number of threads: expects the bytes of an uninterrupted
// bake.
void BakeClass::expectResumes(std::initializer_list<const char*> stop_stages) {
  auto straight = run();
  ASSERT_TRUE(straight) << straight.error().message;
  std::map<std::string, std::vector<uint8_t>> whole;
  for (const char* name : {"go.mp4", "go.bin", "walk.bin", "motion.bin", "character.gltf"}) whole[name] = bytesOf(name);
  const std::vector<std::string> passed = stages;
  for (const char* stage : stop_stages) {
    SCOPED_TRACE(stage);
    ASSERT_NE(std::find(passed.begin(), passed.end(), stage), passed.end());
    fs::remove_all(options.character_folder);
    options.resume = false;
    options.jobs = 2;
    stop_at = stage;
    auto stopped = run();
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().id, ErrorId::Interrupted) << stopped.error().message;
    EXPECT_FALSE(fs::exists(options.character_folder));
    stop_at.clear();
    options.resume = true;
    options.jobs = 1;
    auto resumed = run();
    ASSERT_TRUE(resumed) << resumed.error().message;
    for (const auto& [name, bytes] : whole) EXPECT_TRUE(bytesOf(name) == bytes) << name;
  }
}

TEST_F(BakeClass, StoppedAnywhereResumesToTheSameBytes) { expectResumes({"warp go", "go 1/9", "go 7/9", "graph"}); }

TEST_F(BakeClass, ShowsWhatItsMembersOwnStreamsHaveDrawn) {
  ASSERT_TRUE(run());
  const std::vector<uint8_t> video = bytesOf("go.mp4"), geometry = bytesOf("go.bin");
  fs::remove_all(options.character_folder);
  options.jobs = 1;  // no reading ahead
  stop_at = "run 6/6";
  when_there = [&] {
    for (const char* member : {"walk", "run"})
      for (const char* folder : {"/cam00", "/cam01", "/mask00", "/mask01"}) input.remove(member + std::string(folder));
  };
  auto report = run();
  ASSERT_TRUE(report) << "pictures are read again: " << report.error().message;
  EXPECT_TRUE(bytesOf("go.mp4") == video);
  EXPECT_TRUE(bytesOf("go.bin") == geometry);
}

TEST_F(BakeClass, DrawsAgainWhatIsNotKept) {
  ASSERT_TRUE(run());
  const std::vector<uint8_t> video = bytesOf("go.mp4");
  fs::remove_all(options.character_folder);
  options.jobs = 1;
  stop_at = "go 1/9";
  int kept = 0, left = 0;
  when_there = [&] {
    for (const fs::directory_entry& file : fs::recursive_directory_iterator(options.character_folder + ".work")) {
      if (file.path().extension() != ".layers") continue;
      if (stop_at == "graph") {
        ++left;
      } else if (++kept % 3 == 0) {
        fs::remove(file.path());
      } else if (kept % 3 == 1) {
        std::ofstream(file.path()) << "torn";
      }
    }
    stop_at = "graph";
  };
  ASSERT_TRUE(run());
  EXPECT_GE(kept, kWalkFrames);
  EXPECT_EQ(left, 0) << "layers stay longer than they are needed";
  EXPECT_TRUE(bytesOf("go.mp4") == video);
}

TEST_F(BakeClass, AFailureAfterTheFramesKeepsThem) {
  stop_at = "go 9/9";
  std::string gop;
  when_there = [&] { std::ofstream(gop = workFile(options.character_folder + ".work", "go.0.gop")) << "torn"; };
  options.jobs = 1;
  auto failed = run();
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().id, ErrorId::Internal) << failed.error().message;
  EXPECT_NE(failed.error().message.find("--resume"), std::string::npos) << failed.error().message;
  EXPECT_FALSE(fs::exists(options.character_folder));
  ASSERT_TRUE(fs::exists(gop));
  stop_at.clear();
  options.resume = true;
  auto resumed = run();
  ASSERT_TRUE(resumed) << resumed.error().message;
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "walk 1/9"), 0) << "baked again";
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "go 9/9"), 0) << "baked again";
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "go 4/9"), 1) << "the torn one is not baked again";
}

// Limited to two phases, since alignment draws and compares each one from all sides.
TEST_F(BakeClass, StoppedInAlignmentKeepsThePhasesMeasured) {
  input.setFrames(2, 2);
  options.classes.align = true;
  expectResumes({"align go 1/2"});
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "align go 1/2"), 0) << "measured again";
  const Stream go = stream("go");
  EXPECT_EQ(go.index.alignment_count, 1u);
  EXPECT_NEAR(go.index.alignment_step_m, character().length_scale * kAlignmentStep_m, 1e-9);
  EXPECT_EQ(go.chunks[0].alignment.size(), 2 * go.index.vertex_count);
}

TEST_F(BakeClass, LeftOutWithAMemberOrByOption) {
  options.sequences = {"walk"};
  ASSERT_TRUE(run());
  EXPECT_EQ(character().sequences.size(), 1u);
  EXPECT_TRUE(character().graph_uri.empty()) << "one state has no transitions";
  options.sequences.clear();
  options.classes.bake = false;
  ASSERT_TRUE(run());
  EXPECT_EQ(character().sequences.size(), 2u);
  EXPECT_FALSE(character().graph_uri.empty());
}

TEST_F(BakeClass, PlainSequencesDoNotDependOnClasses) {
  options.classes.bake = false;
  ASSERT_TRUE(run());
  const auto walk = bytesOf("walk.mp4"), run_video = bytesOf("run.mp4");
  options.classes.bake = true;
  ASSERT_TRUE(run());
  EXPECT_TRUE(bytesOf("walk.mp4") == walk);
  EXPECT_TRUE(bytesOf("run.mp4") == run_video);
}

TEST_F(BakeClass, PictureThatIsTooLargeNamesClassAndRemedy) {
  options.texture = 2048;
  expectError(ErrorId::InvalidArgument, "class 'go'");
  expectError(ErrorId::InvalidArgument, "smaller texture, or leave classes out with --no-classes");
}

TEST_F(BakeClass, NameThatIsNoFileIsRefused) {
  input.declare(R"([{"name": "go on", "parameter": "speed_mps", "members": ["walk", "run"]}])");
  expectError(ErrorId::CaptureJson, "'go on'");
}

TEST_F(BakeClass, ClassThatCannotBeIsNamedBeforeTheSurvey) {
  input.declare(R"([{"name": "go", "parameter": "mood", "members": ["walk", "run"]}])");
  expectError(ErrorId::CaptureJson, "go");
  EXPECT_TRUE(std::none_of(stages.begin(), stages.end(), [](const std::string& s) { return s.find("survey") == 0; }));
}

TEST(GraphWeights, MembersAloneAndThreePointsBetweenNeighbours) {
  ClassPlan plan;
  plan.members.resize(3);
  plan.manifest.resize(3);
  plan.space.names = {"speed_mps"};
  const double speeds[] = {2, 1, 3};
  for (int m = 0; m < 3; ++m) plan.manifest[m].parameter = {speeds[m]};
  const auto rows = graphWeights(plan);
  ASSERT_EQ(rows.size(), 3u + 2 * 3);
  EXPECT_EQ(rows[1], (std::vector<float>{0, 1, 0}));
  EXPECT_EQ(rows[3], (std::vector<float>{0.25f, 0.75f, 0})) << "from the slowest on";
  EXPECT_EQ(rows[8], (std::vector<float>{0.25f, 0, 0.75f}));
  plan.members.resize(1);
  EXPECT_EQ(graphWeights(plan), (std::vector<std::vector<float>>{{1}}));
}

}  // namespace
}  // namespace fourdvt::bake
