// SPDX-License-Identifier: Apache-2.0
// Captures whose meshes change their topology, captures of one frame, and captures without meshes.
#include "capture_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

// A fan of `triangles` triangles in the plane z = depth, without UVs.
std::string fanObj(int triangles, double depth) {
  std::string text = "v 0 0 " + std::to_string(depth) + "\n";
  for (int i = 0; i <= triangles; ++i) text += "v 1 " + std::to_string(0.1 * i) + " " + std::to_string(depth) + "\n";
  for (int i = 0; i < triangles; ++i) text += "f 1 " + std::to_string(i + 2) + "//7 " + std::to_string(i + 3) + "\n";
  return text;
}

std::unique_ptr<mattes::FrameReader> readerOf(const Capture& capture) {
  return mattes::FrameReader::open(capture, capture.sequences[0], platform::openVideoFile).take();
}

TEST(CaptureMeshKinds, ConstantTopologyIsTheDefault) {
  SmallCapture files;
  for (const MeshNeed need : {MeshNeed::ConstantTopology, MeshNeed::AnySurface}) {
    const auto capture = mattes::openCapture(files.path(), platform::openVideoFile, {}, need);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_EQ(capture.value().meshes, CaptureMeshes::ConstantTopology);
    EXPECT_EQ(capture.value().topology.vertex_count, 4u);
    const auto surface = readSurfaceFrame(capture.value(), capture.value().sequences[0], 2);
    ASSERT_TRUE(surface.ok()) << surface.error().message;
    EXPECT_EQ(surface.value().faces, capture.value().topology.face_vertices);
    EXPECT_NEAR(surface.value().positions[0].z, 0.2, 1e-6);
    EXPECT_TRUE(readerOf(capture.value())->next().value().faces.empty());
  }
}

TEST(CaptureMeshKinds, EveryFrameHasItsOwnFaces) {
  BareCapture files("per-frame", "", "centimetre");
  for (int k = 0; k < 3; ++k) files.write("walk/mesh/" + numbered(k, ".obj"), fanObj(k + 1, 10 * k));
  const auto capture = files.openAs(MeshNeed::AnySurface);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().meshes, CaptureMeshes::PerFrame);
  EXPECT_EQ(capture.value().topology.faceCount(), 0u);
  const auto reader = readerOf(capture.value());
  for (uint32_t k = 0; k < 3; ++k) {
    const auto frame = reader->next();
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame.value().positions.size(), k + 3);
    ASSERT_EQ(frame.value().faces.size(), k + 1);
    EXPECT_EQ(frame.value().faces[k], glm::uvec3(0, k + 1, k + 2));
    EXPECT_NEAR(frame.value().positions[0].z, 0.1 * k, 1e-6);
    EXPECT_EQ(frame.value().pictures.size(), 2u);
    const auto surface = readSurfaceFrame(capture.value(), capture.value().sequences[0], k);
    ASSERT_TRUE(surface.ok());
    EXPECT_EQ(surface.value().positions, frame.value().positions);
    EXPECT_EQ(surface.value().faces, frame.value().faces);
  }
  expectError(reader->next(), ErrorId::InvalidArgument, "walk");
  expectError(readSurfaceFrame(capture.value(), capture.value().sequences[0], 3), ErrorId::InvalidArgument, "walk");
  expectError(readMeshFrame(capture.value(), capture.value().sequences[0], 0), ErrorId::MeshTopology, files.path());
}

// File names as other programs write them; frame k has k + 1 triangles.
TEST(CaptureMeshKinds, FindsNumberedFiles) {
  struct Names {
    const char *prefix, *suffix;
    int digits, first;
  };
  for (const Names& names : {Names{"", ".obj", 6, 0}, Names{"frame_", ".obj", 4, 1}, Names{"take2_", "_lod0.OBJ", 1, 9},
                             Names{"mesh", ".obj", 5, 1001}}) {
    SCOPED_TRACE(names.prefix);
    BareCapture files;
    for (int k = 0; k < 3; ++k) {
      std::string digits = std::to_string(names.first + k);
      if (int(digits.size()) < names.digits) digits.insert(0, names.digits - digits.size(), '0');
      files.write("walk/mesh/" + (names.prefix + digits + names.suffix), fanObj(k + 1, 0));
    }
    files.write("walk/mesh/notes.txt", std::string("not a mesh"));
    const auto capture = files.openAs(MeshNeed::AnySurface);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    for (uint32_t k = 0; k < 3; ++k) {
      const auto surface = readSurfaceFrame(capture.value(), capture.value().sequences[0], k);
      ASSERT_TRUE(surface.ok()) << surface.error().message;
      EXPECT_EQ(surface.value().faces.size(), k + 1);
    }
  }
}

TEST(CaptureMeshKinds, AGivenPatternMayBeginAtAnyNumber) {
  BareCapture files("per-frame", R"(, "mesh": "scans/s%03d.obj")");
  for (int k = 0; k < 3; ++k) files.write("scans/s00" + std::to_string(k + 1) + ".obj", fanObj(k + 1, 0));
  const auto capture = files.openAs(MeshNeed::AnySurface);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(readSurfaceFrame(capture.value(), capture.value().sequences[0], 2).value().faces.size(), 3u);
}

void expectWords(const BareCapture& files, ErrorId id, const std::string& file, const std::string& words) {
  const auto capture = files.openAs(MeshNeed::AnySurface);
  expectError(capture, id, files / file);
  if (!capture.ok()) EXPECT_NE(capture.error().message.find(words), std::string::npos) << capture.error().message;
}

// Two candidate series are an error, whatever follows their numbers and whichever is longer; a series that is too short
// is no candidate.
TEST(CaptureMeshKinds, SeveralSeriesAreNamed) {
  BareCapture files;
  for (int k = 0; k < 3; ++k) {
    files.write("walk/mesh/a" + std::to_string(k) + ".obj", fanObj(1, 0));
    files.write("walk/mesh/b_00" + std::to_string(k) + ".ply", fanObj(1, 0));
  }
  files.write("walk/mesh/c0.obj", fanObj(1, 0));
  expectWords(files, ErrorId::InvalidArgument, "walk/mesh", "(a%d.obj, b_%03d.ply)");
  expectWords(files, ErrorId::InvalidArgument, "walk/mesh", "\"mesh\": \"walk/mesh/a%d.obj\"");
  files.write("walk/mesh/b_003.ply", fanObj(1, 0));
  expectWords(files, ErrorId::InvalidArgument, "walk/mesh", "(a%d.obj, b_%03d.ply)");
  files.remove("walk/mesh/b_001.ply");
  files.remove("walk/mesh/b_002.ply");
  EXPECT_TRUE(files.openAs(MeshNeed::AnySurface).ok());
}

// A gap is reported by the number of the missing file.
TEST(CaptureMeshKinds, AHoleHasItsNumber) {
  BareCapture files;
  for (const int number : {9, 11, 12}) files.write("walk/mesh/scan_" + std::to_string(number) + ".obj", fanObj(1, 0));
  expectWords(files, ErrorId::FileMissing, "walk/mesh/scan_10.obj", "1 of the 3 frames");
}

TEST(CaptureMeshKinds, OtherKindsAreNamed) {
  BareCapture files;
  files.write("walk/mesh/performance.abc", std::string("Ogawa"));
  expectWords(files, ErrorId::Unsupported, "walk/mesh/performance.abc", "Alembic is not read; export one OBJ");
  files.declare("constant");
  expectWords(files, ErrorId::Unsupported, "walk/mesh/performance.abc", "Alembic is not read; export one OBJ");
  for (const std::string pattern : {"walk/mesh/performance.abc", "walk/mesh/%04d.usdc"}) {
    files.declare("per-frame", R"(, "mesh": ")" + pattern + "\"");
    expectWords(files, ErrorId::Unsupported, "capture.json", "which is not read; export one OBJ");
  }
  files.declare("per-frame");
  files.remove("walk/mesh/performance.abc");
  files.write("walk/mesh/statue.obj", fanObj(1, 0));
  expectWords(files, ErrorId::InvalidArgument, "walk/mesh/statue.obj", "is one mesh, but \"walk\" has 3 frames");
}

TEST(CaptureMeshKinds, OneFrameIsASequence) {
  for (const bool given : {false, true}) {
    BareCapture files;
    files.write("capture.json", std::string(R"({"fps": 25, "topology": "per-frame", "sequences": [{"name": "walk",
                                              "frames": 1)") +
                                    (given ? R"(, "mesh": "walk/mesh/statue.obj")" : "") + "}]}");
    files.write("walk/mesh/statue.obj", fanObj(5, 0));
    const auto capture = files.openAs(MeshNeed::AnySurface);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_EQ(readerOf(capture.value())->next().value().faces.size(), 5u);
  }
}

TEST(CaptureMeshKinds, WithoutMeshesThePicturesAreRead) {
  for (const std::string extra : {"", R"(, "mesh": null)"}) {
    BareCapture files("constant", extra);
    if (!extra.empty()) files.write("walk/mesh/000000.obj", std::string("not used"));
    const auto capture = files.openAs(MeshNeed::Nothing);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_EQ(capture.value().meshes, CaptureMeshes::None);
    const auto reader = readerOf(capture.value());
    for (int k = 0; k < 3; ++k) {
      const auto frame = reader->next();
      ASSERT_TRUE(frame.ok()) << frame.error().message;
      EXPECT_EQ(frame.value().pictures[1].at(3, 4)[0], 10 * k + 1);
      EXPECT_TRUE(frame.value().positions.empty());
      EXPECT_TRUE(frame.value().faces.empty());
    }
    expectError(reader->next(), ErrorId::InvalidArgument, "walk");
    expectError(readSurfaceFrame(capture.value(), capture.value().sequences[0], 0), ErrorId::FileMissing, files.path());
    expectError(readMeshFrame(capture.value(), capture.value().sequences[0], 0), ErrorId::MeshTopology, files.path());
  }
}

// Readers that need no meshes are not stopped by broken ones.
TEST(CaptureMeshKinds, MeshesThatNobodyWantsAreNotRead) {
  SmallCapture constant;
  constant.write("walk/mesh/000000.obj", std::string("v nan\n"));
  BareCapture per_frame;  // no files at all
  for (const std::string& path : {constant.path(), per_frame.path()}) {
    const auto capture = mattes::openCapture(path, platform::openVideoFile, {}, MeshNeed::Nothing);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_EQ(capture.value().meshes, CaptureMeshes::None);
    EXPECT_TRUE(readerOf(capture.value())->next().ok());
  }
}

// A reader that needs constant topology, as a bake does, rejects others with a remedy.
TEST(CaptureMeshKinds, ANeedThatIsNotMetIsRefused) {
  BareCapture files("constant");
  for (const MeshNeed need : {MeshNeed::ConstantTopology, MeshNeed::AnySurface}) {
    const auto none = files.openAs(need);
    expectError(none, ErrorId::FileMissing, files / "capture.json");
    EXPECT_NE(none.error().message.find("fourdvt reconstruct"), std::string::npos) << none.error().message;
  }
  files.declare("constant", R"(, "mesh": null)");
  files.write("walk/mesh/000000.obj", quadObj(0));  // declared as unused
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::FileMissing, files / "capture.json");
  files.remove("walk/mesh");
  files.declare("per-frame");
  const auto free = files.open();  // the files need not exist
  expectError(free, ErrorId::MeshTopology, files / "capture.json");
  EXPECT_NE(free.error().message.find("layers need meshes of constant topology with UVs"), std::string::npos);
}

TEST(CaptureMeshKinds, FramesMissingInTheMiddleAreCounted) {
  BareCapture files;
  files.write("walk/mesh/000000.obj", fanObj(1, 0));
  const auto two = files.openAs(MeshNeed::AnySurface);
  expectError(two, ErrorId::FileMissing, files / "walk/mesh/000001.obj");
  EXPECT_NE(two.error().message.find("2 of the 3 frames"), std::string::npos) << two.error().message;
  files.write("walk/mesh/000002.obj", fanObj(1, 0));
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::FileMissing, files / "walk/mesh/000001.obj");
  files.remove("walk/mesh/000000.obj");
  files.write("walk/mesh/000001.obj", fanObj(1, 0));
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::FileMissing, files / "walk/mesh/000000.obj");
}

TEST(CaptureMeshKinds, NoMeshesWherePerFrameIsDeclared) {
  BareCapture files;
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::FileMissing, files / "walk/mesh");
}

// The first frame is parsed when the capture is opened, the others when they are read.
TEST(CaptureMeshKinds, BrokenFramesAreNamed) {
  BareCapture files;
  for (int k = 0; k < 3; ++k) files.write("walk/mesh/" + numbered(k, ".obj"), fanObj(1, 0));
  files.write("walk/mesh/000002.obj", std::string("v 0 0 0\nf 1 2 3\n"));
  const auto capture = files.openAs(MeshNeed::AnySurface);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const auto reader = readerOf(capture.value());
  reader->skipTo(2);
  expectError(reader->next(), ErrorId::MeshIndex, files / "walk/mesh/000002.obj");
  files.write("walk/mesh/000000.obj", std::string("v 0 0 nan\n"));
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::MeshNotFinite, files / "walk/mesh/000000.obj");
}

TEST(CaptureMeshKinds, OneSequenceWithoutMeshes) {
  SmallCapture files;
  files.write("capture.json", std::string(R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3},
                                             {"name": "run", "frames": 3}]})"));
  expectError(files.open(), ErrorId::FileMissing, files / "run/mesh");
  EXPECT_TRUE(mattes::openCapture(files.path(), platform::openVideoFile, {"walk"}).ok());
}

TEST(CaptureMeshKinds, WrongDeclarations) {
  BareCapture files("free");
  expectError(files.openAs(MeshNeed::Nothing), ErrorId::CaptureJson, files / "capture.json");
  files.declare("per-frame",
                R"(, "mesh": {"topology": "walk/mesh/000000.obj", "positions": "p.i16", "units_per_metre": 100})");
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::CaptureJson, files / "capture.json");
  files.declare("per-frame", R"(, "mesh": 7)");
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::CaptureJson, files / "capture.json");
  files.declare("per-frame", R"(, "mesh": "statue.obj")");  // three frames
  expectError(files.openAs(MeshNeed::AnySurface), ErrorId::CaptureJson, files / "capture.json");
}

}  // namespace
}  // namespace fourdvt::capture
