// SPDX-License-Identifier: Apache-2.0
#include "capture/folder/linked_capture.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "capture/mesh_file.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

TEST(LinkedCapture, HeldOutFramesFollowTheNewRange) {
  SmallCapture given;
  given.write("capture.json", R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3, "test_frames": [0, 1, 2]}]})");
  auto capture = given.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  CaptureSequence& walk = capture.value().sequences[0];
  walk.first_frame = 1;
  walk.frame_count = 1;
  walk.offset_frames = {{capture.value().cameras[0].pinhole.name, 0.25}};
  const std::filesystem::path to = given.path() + "_linked";
  std::filesystem::create_directories(to);
  LinkOptions options;
  options.sequences = {"walk"};
  options.own_times = true;
  const Status linked = linkCapture(capture.value(), to.string(), options);
  ASSERT_TRUE(linked.ok()) << linked.error().message;
  std::ifstream file(to / "capture.json");
  const auto sequence = nlohmann::json::parse(file)["sequences"][0];
  EXPECT_EQ(sequence["frames"], 1);
  EXPECT_EQ(sequence["first_frame"], 1);
  EXPECT_EQ(sequence["test_frames"], nlohmann::json::array({0}));  // given frame 1; frames 0 and 2 are outside
  EXPECT_EQ(sequence["offset_frames"].size(), 1u);
  std::filesystem::remove_all(to);
}

constexpr double kUnitsPerMetre = 8000;

// A capture with meshes of each form, in centimetres, and the packed capture that is made of it.
class PackedCapture : public ::testing::Test {
 protected:
  PackedCapture() : to_(given_.path() + "_linked") {
    std::filesystem::create_directories(to_);
    for (const char* name : {"run", "hop", "leap"})
      std::filesystem::copy(given_ / "walk", given_ / name, std::filesystem::copy_options::recursive);
    for (int frame = 0; frame < 3; ++frame) {
      given_.write("run/scans/" + numbered(frame, ".obj"), quadObj(0));
      given_.write("hop/" + numbered(frame, ".obj"), quadObj(0));
    }
    given_.write("leap/take.glb", std::string("glTF"));
    given_.write("mesh_topology.obj", quadObj(0));
    given_.write("track.json", std::string("{}"));
    given_.write("track-0.jpg", std::string());
    given_.write("notes.txt", std::string("kept"));
    given_.write("capture.json",
                 std::string(R"({"fps": 25, "units": "centimetre", "topology": "per-frame", "sequences": [
      {"name": "walk", "frames": 2, "first_frame": 1},
      {"name": "run", "frames": 3, "loop": true, "root_velocity": [0, 0, 100], "mesh": "run/scans/%06d.obj"},
      {"name": "hop", "frames": 3, "mesh": "hop/%06d.obj"}, {"name": "leap", "frames": 3, "mesh": "leap/take.glb"}],
      "classes": [{"name": "old", "parameter": "speed_mps", "members": ["walk", "hop"]}]})"));
  }
  ~PackedCapture() override { std::filesystem::remove_all(to_); }

  void link(const LinkOptions& options) {
    auto capture = mattes::openCapture(given_.path(), platform::openVideoFile, {}, MeshNeed::Nothing);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    for (CaptureSequence& sequence : capture.value().sequences) {
      sequence.loop = sequence.name != "leap";
      sequence.root_velocity_mps = glm::dvec3(sequence.name == "walk" ? 1.5 : 0, 0, 0);
      if (sequence.name == "walk") sequence.travel = CaptureTravel{{glm::radians(90.0), {0, 1.25}}, {-0.5, 0}};
    }
    const Status linked = linkCapture(capture.value(), to_.string(), options);
    ASSERT_TRUE(linked.ok()) << linked.error().message;
  }
  static LinkOptions packed() {
    LinkOptions options;
    options.sequences = {"walk", "run", "hop", "leap"};
    options.meshes = LinkedMeshes::Packed;
    options.units_per_metre = kUnitsPerMetre;
    return options;
  }
  nlohmann::json json() const { return nlohmann::json::parse(std::ifstream(to_ / "capture.json")); }
  bool has(const char* name) const { return std::filesystem::exists(std::filesystem::symlink_status(to_ / name)); }

  SmallCapture given_;
  std::filesystem::path to_;
};

// [frame] positions of a quad that moves, metres.
Positions quadAt(int frame) {
  const float x = 0.0123f * float(frame);
  return {{x, 0, -1}, {x + 1, 0.3333f, -1}, {x + 1, 1.7777f, -1}, {x, 1.7777f, -1}};
}

TEST_F(PackedCapture, GivesItsPositionsBack) {
  link(packed());
  MeshTopology topology;
  topology.vertex_count = 4;
  topology.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  topology.face_vertices = topology.face_uvs = {{0, 1, 2}, {0, 2, 3}};
  std::ofstream(to_ / kMeshTopology) << objText(topology, quadAt(0), 1);
  for (const char* name : {"walk", "run", "hop", "leap"}) {
    std::vector<uint8_t> bytes;
    for (int frame = 0; frame < 3; ++frame) appendPacked(quadAt(frame), kUnitsPerMetre, bytes);
    std::ofstream(to_ / name / kMeshFolder / kPackedPositions, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  }
  const auto opened = openDescription(to_.string(), {}, MeshNeed::ConstantTopology);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ(opened.value().topology.face_vertices, topology.face_vertices);
  EXPECT_EQ(opened.value().topology.uvs, topology.uvs);
  for (const CaptureSequence& sequence : opened.value().sequences)
    for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
      const auto positions = readMeshFrame(opened.value(), sequence, frame);
      ASSERT_TRUE(positions.ok()) << positions.error().message;
      const Positions truth = quadAt(int(sequence.first_frame + frame));
      for (size_t v = 0; v < truth.size(); ++v)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(positions.value()[v][k], truth[v][k], 0.501 / kUnitsPerMetre);
    }
}

TEST_F(PackedCapture, LinksPicturesAndNoMeshes) {
  link(packed());
  for (const char* name : {"mesh_topology.obj", "walk/mesh/000000.obj", "run/mesh/000000.obj", "run/scans",
                           "hop/000000.obj", "leap/take.glb", "track.json", "track-0.jpg"})
    EXPECT_FALSE(has(name)) << name;
  for (const char* name : {"notes.txt", "cameras", "walk/cam00", "hop/mask01"}) EXPECT_TRUE(has(name)) << name;
  EXPECT_FALSE(json().contains("topology"));
}

TEST_F(PackedCapture, KeepsAFolderThatHasMoreThanMeshes) {
  given_.write("run/scans/sound.wav", std::string("RIFF"));
  link(packed());
  EXPECT_TRUE(has("run/scans/sound.wav"));
}

TEST_F(PackedCapture, HasTheClassesOfTheOptions) {
  LinkOptions options = packed();
  options.classes = {{"locomotion", {kMeasuredParameter}, {{"walk", {}}, {"run", {}}}, {}}};
  options.own_motion = true;
  link(options);
  const auto read = json();
  ASSERT_EQ(read["classes"].size(), 1u);
  EXPECT_EQ(read["classes"][0]["name"], "locomotion");
  EXPECT_EQ(read["classes"][0]["members"], nlohmann::json::array({"walk", "run"}));
  const auto opened = openDescription(to_.string(), {}, MeshNeed::Nothing);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ(opened.value().classes.size(), 1u);
  link(packed());
  EXPECT_FALSE(json().contains("classes"));
}

TEST_F(PackedCapture, HasTheLoopsAndVelocitiesOfTheCapture) {
  LinkOptions options = packed();
  options.own_motion = true;
  link(options);
  const auto sequences = json()["sequences"];
  EXPECT_EQ(sequences[0]["loop"], true);
  EXPECT_EQ(sequences[3]["loop"], false);
  EXPECT_EQ(sequences[0]["root_velocity"], nlohmann::json::array({150.0, 0.0, 0.0}));  // centimetres
  EXPECT_FALSE(sequences[1].contains("root_velocity"));
  EXPECT_EQ(sequences[0]["travel"],
            (nlohmann::json{{"shift", {0.0, 125.0}}, {"turn_deg", 90.0}, {"place", {-50.0, 0.0}}}));
  EXPECT_FALSE(sequences[1].contains("travel"));
  link(packed());
  EXPECT_FALSE(json()["sequences"][0].contains("loop"));
  EXPECT_EQ(json()["sequences"][1]["root_velocity"], nlohmann::json::array({0, 0, 100}));
}

}  // namespace
}  // namespace fourdvt::capture
