// SPDX-License-Identifier: Apache-2.0
// Frames and manifests of live streams: round trips; values outside the limits are rejected with the field's name.
#include <gtest/gtest.h>

#include "live_stream_fixture.h"

using namespace fourdvt;
using namespace fourdvt::package;
using namespace fourdvt::testing;

namespace {

const std::string kExtension = std::string("/extensions/") + kExtensionName;

std::vector<uint8_t> smallFrame() {
  const std::vector<uint8_t> chunk{1, 2, 3}, sample{4, 5};
  return writeLiveFrame({0xfffffffe, true, -5, chunk, sample});
}

std::vector<uint8_t> with(std::vector<uint8_t> bytes, size_t at, uint8_t value) {
  bytes.at(at) = value;
  return bytes;
}

std::string problemOf(const std::string& field, FlatJson::Value value) {
  FlatJson manifest = liveManifest();
  manifest.set(kExtension + field, std::move(value));
  const auto read = readLiveManifest(manifest);
  if (read.ok()) return "";
  EXPECT_EQ(read.error().id, ErrorId::ManifestInvalid) << field;
  return read.error().message;
}

TEST(LiveFrame, ComesBackAsItWasWritten) {
  const std::vector<uint8_t> bytes = smallFrame();
  const LiveFrame frame = readLiveFrame(bytes).take();
  EXPECT_EQ(frame.number, 0xfffffffe);
  EXPECT_TRUE(frame.key);
  EXPECT_EQ(frame.captured_us, -5);
  EXPECT_EQ(std::vector<uint8_t>(frame.chunk.begin(), frame.chunk.end()), (std::vector<uint8_t>{1, 2, 3}));
  EXPECT_EQ(std::vector<uint8_t>(frame.sample.begin(), frame.sample.end()), (std::vector<uint8_t>{4, 5}));
}

TEST(LiveFrame, WhatIsNoneIsRefused) {
  const std::vector<uint8_t> bytes = smallFrame();
  for (size_t length = 0; length < bytes.size(); ++length)
    EXPECT_EQ(readLiveFrame(std::span(bytes).first(length)).error().id, ErrorId::StreamInvalid) << length;
  std::vector<uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_EQ(readLiveFrame(longer).error().id, ErrorId::StreamInvalid);
  EXPECT_EQ(readLiveFrame(with(bytes, 0, 'X')).error().id, ErrorId::StreamInvalid);
  EXPECT_EQ(readLiveFrame(with(bytes, 4, 2)).error().id, ErrorId::Unsupported) << "version";
  EXPECT_EQ(readLiveFrame(with(bytes, 6, 3)).error().id, ErrorId::StreamInvalid) << "flags";
  EXPECT_EQ(readLiveFrame(with(bytes, 27, 0xff)).error().id, ErrorId::StreamInvalid) << "a chunk of 4 GB";
  const std::vector<uint8_t> some{1};
  EXPECT_EQ(readLiveFrame(writeLiveFrame({1, true, 0, {}, some})).error().id, ErrorId::StreamInvalid);
  EXPECT_EQ(readLiveFrame(writeLiveFrame({1, true, 0, some, {}})).error().id, ErrorId::StreamInvalid);
  const std::vector<uint8_t> large(kMaxLiveFrameBytes);
  EXPECT_EQ(readLiveFrame(writeLiveFrame({1, true, 0, large, some})).error().id, ErrorId::StreamInvalid);
}

TEST(LiveManifest, IsACharacterFromCamerasWithoutFiles) {
  const auto read = readLiveManifest(liveManifest());
  ASSERT_TRUE(read.ok()) << read.error().message;
  const LiveCharacter& live = read.value();
  EXPECT_EQ(live.session, 0x00c0ffee12345678u);
  const Character& c = live.character;
  EXPECT_EQ(c.appearance, AppearanceKind::Cameras);
  EXPECT_EQ(c.name, "body");
  EXPECT_EQ(c.method.name, "fvvr");
  EXPECT_EQ(c.cameras.size(), 2u);
  EXPECT_EQ(c.ground_y_m, 0.25);
  EXPECT_EQ(c.bounds.max.y, 1.7f);
  ASSERT_EQ(c.sequences.size(), 1u);
  const Sequence& s = c.sequences[0];
  EXPECT_EQ(s.name, "live");
  EXPECT_EQ(s.fps, 25);
  EXPECT_EQ(s.layout_width, 64);
  EXPECT_EQ(s.layout_height, 48);
  ASSERT_EQ(s.renditions.size(), 1u);
  EXPECT_EQ(s.renditions[0].codec, "avc1.42C01F");
  EXPECT_EQ(s.renditions[0].tiles.y, 16);
  EXPECT_EQ(s.renditions[0].barcode.cell_size, 4);
  EXPECT_EQ(live.index.position_origin, kSurfaceOrigin_m);
  EXPECT_EQ(live.index.position_step_m, kSurfaceStep_m);
  EXPECT_EQ(live.index.vertex_count, 200u);
  const std::vector<uint8_t> chunk = liveChunk(3);
  auto surfaces = SurfaceChunk::open(chunk, live.index, 0, c, s);
  ASSERT_TRUE(surfaces.ok()) << surfaces.error().message;
  EXPECT_TRUE(surfaces.value()->decodeTo(0).ok());
  EXPECT_EQ(surfaces.value()->surface(0).faces.size(), facesOf(3));
}

TEST(LiveManifest, EveryFieldOutsideItsLimitsIsNamed) {
  struct Wrong {
    const char* field;
    FlatJson::Value value;
    const char* named = nullptr;  // where a rule is of several fields
  };
  const std::vector<Wrong> all{
      {"/live/session", std::string("short")},
      {"/live/session", 7.0},
      {"/live/fps", 0.0},
      {"/live/fps", std::string("25")},
      {"/live/layout/0", 0.0},
      {"/live/layout/1", 8193.0},
      {"/live/layout/2", 1.0, "/live/layout"},
      {"/live/codec", std::string()},
      {"/live/width", 191.0, "/live"},
      {"/live/height", 4098.0},
      {"/live/tiles/2", 193.0, "/live/tiles"},
      {"/live/tiles/3", 0.0, "/live/tiles"},
      {"/live/barcode/cellSize", 5.0, "/live/barcode"},
      {"/live/barcode/rect/0", 65.0, "/live/barcode"},
      {"/live/origin/0", 1e7},
      {"/live/step", 0.0},
      {"/live/step", 2.0},
      {"/appearance", std::string("layers")},
      {"/name", std::string(129, 'a')},
      {"/vertexCount", 2.0},
      {"/faceCount", 4194305.0},
      {"/bounds/min/1", 2.0, "/bounds"},
      {"/groundY", 1e7},
      {"/lengthScale", 0.0},
      {"/method/name", std::string("A b")},
      {"/cameras/1/width", 0.0},
      {"/cameras/1/camFromWorld/0", 9.0, "/cameras/1/camFromWorld"},
      {"/cameras/2/name", std::string("half a camera"), "/cameras/2/"},
  };
  for (const Wrong& wrong : all) {
    const std::string problem = problemOf(wrong.field, wrong.value);
    const std::string named = kExtension + (wrong.named ? wrong.named : wrong.field);
    EXPECT_NE(problem.find(named), std::string::npos) << wrong.field << ": " << problem;
  }
}

TEST(LiveManifest, VersionsAreToldApart) {
  FlatJson manifest = liveManifest();
  EXPECT_EQ(readManifest(manifest).error().id, ErrorId::Unsupported);
  EXPECT_NE(readManifest(manifest).error().message.find("WebSocket"), std::string::npos);
  manifest.set(kExtension + "/version", 5.0);
  EXPECT_EQ(readLiveManifest(manifest).error().id, ErrorId::Unsupported);
  EXPECT_EQ(readManifest(manifest).error().id, ErrorId::Unsupported);
  manifest.set(kExtension + "/version", 2.0);
  EXPECT_EQ(readLiveManifest(manifest).error().id, ErrorId::ManifestInvalid);
  EXPECT_EQ(readLiveManifest({}).error().id, ErrorId::ManifestInvalid);
  FlatJson old = liveManifest();
  old.set("/asset/version", std::string("1.0"));
  EXPECT_EQ(readLiveManifest(old).error().id, ErrorId::ManifestInvalid);
}

}  // namespace
