// SPDX-License-Identifier: Apache-2.0
// Pictures and files of the studio: known surface points have the texture's colours in every picture, with and without
// drift; the ends of the truth equal the sequences' own pictures; the folder opens as a capture and is reproducible.
#include <atomic>

#include "capture/capture.h"
#include "lab/studio/set.h"
#include "mattes/frame_reader.h"
#include "platform/ffmpeg_video.h"
#include "studio_fixture.h"

namespace fourdvt::studio {
namespace {

// Compares pictures with the texture at the tracked vertices that a camera sees well inside the outline.
void expectColoursOfTexture(StudioSet& set, const std::vector<double>& shares, double phase, double place) {
  set.pose(shares, phase);
  const Tracker& tracker = set.tracker();
  const auto points = tracker.points(place, phase);
  const Positions vertices = set.truth();
  std::vector<glm::vec3> normals;
  computeVertexNormals(tracker.trackedSurface().faces(), vertices.data(), vertices.size(), normals);
  const MeshTopology& surface = set.actor().surface().topology;
  const Image& texture = set.actor().texture();
  int checked = 0;
  double error = 0, contrast = 0;
  for (const PinholeCamera& camera : set.rig().ring) {
    const Image picture = set.draw(camera).take();
    for (size_t v = 0; v < vertices.size(); ++v) {
      const glm::dvec3 to_eye = glm::normalize(camera.centreInWorld() - glm::dvec3(vertices[v]));
      if (glm::dot(glm::dvec3(normals[v]), to_eye) < 0.85) continue;
      // Excludes points that other parts of the body may hide: keeps the torso's front and back only.
      if (set.actor().tracked().positions[v].y < 1.15 || std::abs(set.actor().tracked().positions[v].x) > 0.1) continue;
      const glm::dvec3 pixel = camera.project(vertices[v]);
      const uint8_t* seen = picture.at(int(pixel.x), int(pixel.y));
      glm::dvec2 uv(0);
      for (int k = 0; k < 3; ++k)
        uv += points[v].share[k] * glm::dvec2(surface.uvs[surface.face_uvs[points[v].face][k]]);
      const uint8_t* painted = texture.at(int(uv.x * texture.width), int(uv.y * texture.height));
      for (int c = 0; c < 3; ++c) {
        error += std::abs(seen[c] - painted[c]);
        contrast += std::abs(painted[c] - 90.0);
      }
      ++checked;
    }
  }
  ASSERT_GT(checked, 100);
  // Compares with the pixel next to the point, on a texture full of edges: the error must be well below the contrast.
  EXPECT_LT(error, 0.30 * contrast) << error / checked / 3 << " levels of " << contrast / checked / 3;
}

TEST_F(StudioTest, PicturesShowTheTextureWhereTheCameraPutsIt) {
  StudioOptions o = small("x");
  o.width = 1200;
  o.height = 1600;
  o.knobs.shading = 0;
  auto plain = StudioSet::open(o, *device);
  ASSERT_TRUE(plain) << plain.error().message;
  expectColoursOfTexture(*plain.value(), {1, 0}, 0.2, 0);
  o.knobs.drift_mm = 30;
  auto drifting = StudioSet::open(o, *device);
  ASSERT_TRUE(drifting) << drifting.error().message;
  expectColoursOfTexture(*drifting.value(), {1, 0}, 0.2, 0);
  expectColoursOfTexture(*drifting.value(), {0, 1}, 0.6, 1);
}

TEST_F(StudioTest, PlainActorIsOfOneColourWithoutLight) {
  StudioOptions o = small("x");
  o.knobs.shading = 0;
  o.knobs.plain = true;
  auto set = StudioSet::open(o, *device);
  ASSERT_TRUE(set) << set.error().message;
  const Image& texture = set.value()->actor().texture();
  double mean[3] = {};
  for (size_t i = 0; i < texture.pixels.size(); ++i)
    mean[i % 3] += double(texture.pixels[i]) / (double(texture.pixels.size()) / 3);
  set.value()->pose({1, 0}, 0.2);
  int inside = 0;
  for (const PinholeCamera& camera : set.value()->rig().ring) {
    const Image picture = set.value()->draw(camera).take();
    for (size_t i = 0; i < picture.pixels.size(); i += 4) {
      if (picture.pixels[i + 3] < 255) continue;
      ++inside;
      for (size_t k = 0; k < 3; ++k) ASSERT_NEAR(picture.pixels[i + k], mean[k], 1);
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST_F(StudioTest, CaptureOpensAndTruthEndsAreTheSequencesOwnPictures) {
  StudioOptions o = small("a");
  o.knobs.drift_mm = 12;
  o.knobs.wrinkles = 0.5;
  o.knobs.noise_levels = 2;
  o.knobs.gain_percent = 3;
  auto report = run(o);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report.value().frames, 10u);
  const auto files = filesOf(o.folder);
  for (const char* camera : {"/test00", "/test01", "/test02"}) {
    EXPECT_TRUE(files.at("truth/locomotion/w000" + std::string(camera) + "/0000.png") ==
                files.at("walk" + std::string(camera) + "/0000.png"));
    EXPECT_TRUE(files.at("truth/locomotion/w100" + std::string(camera) + "/0000.png") ==
                files.at("run" + std::string(camera) + "/0000.png"));
    EXPECT_TRUE(files.at("truth/locomotion/w100" + std::string(camera) + "/0001.png") ==
                files.at("run" + std::string(camera) + "/0002.png"));  // half a cycle of 4 frames
  }
  const uint32_t vertices = report.value().vertices;
  const std::string walk = files.at("walk/mesh/positions.i16"),
                    truth = files.at("truth/locomotion/w000/mesh/positions.i16");
  ASSERT_EQ(truth.size(), size_t{vertices} * 6 * 2);
  EXPECT_TRUE(walk.substr(0, size_t{vertices} * 6) == truth.substr(0, size_t{vertices} * 6));
  EXPECT_EQ(files.at("truth/locomotion/alignment/run/0001.bin").size(), size_t{vertices} * 12);

  auto capture = mattes::openCapture(o.folder, platform::openVideoFile);
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_EQ(capture.value().sequences.size(), 2u);
  EXPECT_EQ(capture.value().sequences[0].frame_count, 6u);
  EXPECT_TRUE(capture.value().sequences[1].loop);
  EXPECT_NEAR(capture.value().sequences[1].root_velocity_mps.z, 2.6, 1e-9);
  EXPECT_EQ(capture.value().sequences[0].test_frames, (std::vector<uint32_t>{0, 2, 4}));
  EXPECT_EQ(capture.value().topology.vertex_count, vertices);
}

TEST_F(StudioTest, VideosDecodeToThePicturesAndMattesAreLossless) {
  StudioOptions o = small("pictures");
  o.truth_at.clear();
  o.sequences = {"run"};
  ASSERT_TRUE(run(o));
  o.folder = folder_ + "/videos";
  o.images = false;
  ASSERT_TRUE(run(o));
  const auto open = [&](const std::string& name) {
    auto capture = mattes::openCapture(folder_ + name, platform::openVideoFile);
    EXPECT_TRUE(capture) << capture.error().message;
    auto reader =
        mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile).take();
    return reader;
  };
  auto pictures = open("/pictures"), videos = open("/videos");
  for (int frame = 0; frame < 4; ++frame) {
    const mattes::CaptureFrame a = pictures->next().take(), b = videos->next().take();
    for (size_t c = 0; c < a.pictures.size(); ++c) {
      double difference = 0;
      for (size_t i = 0; i < a.pictures[c].pixels.size(); ++i) {
        const int d = std::abs(a.pictures[c].pixels[i] - b.pictures[c].pixels[i]);
        difference += d;
        if (i % 4 == 3) {
          ASSERT_EQ(d, 0);
        }
      }
      EXPECT_LT(difference / double(a.pictures[c].pixels.size()), 4);  // 4:2:0 on a small picture full of edges
    }
  }
}

TEST_F(StudioTest, SameOptionsGiveTheSameBytesAndSeedsMatter) {
  StudioOptions o = small("first");
  o.images = false;
  o.sequences = {"run"};
  o.truth_at.clear();
  o.knobs.noise_levels = 2;
  o.knobs.rotation_deg = 0.1;
  ASSERT_TRUE(run(o));
  auto first = filesOf(o.folder);
  ASSERT_TRUE(run(o));  // replaces the earlier capture
  const auto again = filesOf(o.folder);
  ASSERT_EQ(first.size(), again.size());
  for (const auto& [name, bytes] : first) EXPECT_TRUE(again.at(name) == bytes) << name;
  o.knobs.seed = 2;
  ASSERT_TRUE(run(o));
  const auto other = filesOf(o.folder);
  EXPECT_NE(first.at("cameras/images.txt"), other.at("cameras/images.txt"));
  EXPECT_EQ(first.at("cameras_true/images.txt"), other.at("cameras_true/images.txt"));
  EXPECT_FALSE(first.at("run/cam00.mp4") == other.at("run/cam00.mp4"));
  EXPECT_TRUE(first.at("run/test00/0000.png") == other.at("run/test00/0000.png"));
}

TEST_F(StudioTest, KeepsWhatIsNotAStudioCapture) {
  StudioOptions o = small("notes");
  fs::create_directories(o.folder);
  std::ofstream(o.folder + "/notes.txt") << "somebody's work";
  const auto refused = run(o);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(filesOf(o.folder).size(), 1u);
}

TEST_F(StudioTest, StoppingLeavesNothing) {
  const StudioOptions o = small("stopped");
  std::atomic<bool> stop{true};
  const auto stopped = runStudio(o, {device.get(), {}, &stop});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().id, ErrorId::Interrupted);
  EXPECT_FALSE(fs::exists(o.folder));
  EXPECT_FALSE(fs::exists(o.folder + ".work"));
}

}  // namespace
}  // namespace fourdvt::studio
