// SPDX-License-Identifier: Apache-2.0
// Animated glTF: nodes, morph targets and skins, by the rules of each interpolation, and several takes in one file.
#include "capture/mesh_file.h"
#include "capture_fixture.h"
#include "mesh_files.h"

namespace fourdvt::capture {
namespace {

// A glTF file built accessor by accessor.
class MovingGltf {
 public:
  std::string nodes = R"([{"mesh": 0}])", primitive, mesh_extra, root_extra;

  // Returns the accessor's index. `extra`: further fields.
  size_t add(const std::vector<float>& values, const std::string& type, size_t width, const std::string& extra = "") {
    return addRaw(rawBytes(values), type, values.size() / width, 5126, extra);
  }
  size_t addRaw(const std::string& bytes, const std::string& type, size_t count, int component,
                const std::string& extra = "") {
    const size_t view = addView(bytes);
    return describe("\"bufferView\": " + std::to_string(view) + ", ", type, count, component, extra);
  }
  size_t addView(const std::string& bytes) {
    append(views_, "{\"buffer\": 0, \"byteOffset\": " + std::to_string(buffer_.size()) +
                       ", \"byteLength\": " + std::to_string(bytes.size()) + "}");
    buffer_ += bytes;
    return view_count_++;
  }
  size_t describe(const std::string& source, const std::string& type, size_t count, int component,
                  const std::string& extra) {
    append(accessors_, "{" + source + "\"componentType\": " + std::to_string(component) + ", \"type\": \"" + type +
                           "\", \"count\": " + std::to_string(count) + extra + "}");
    return accessor_count_++;
  }

  // Adds an animation of one channel.
  void animate(const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
               const std::string& type, size_t width, const std::string& interpolation = "LINEAR", int node = 0) {
    const size_t input = add(times, "SCALAR", 1), output = add(values, type, width);
    append(animations_, R"({"name": "clip)" + std::to_string(animation_count_++) +
                            R"(", "channels": [{"sampler": 0, "target": {"node": )" + std::to_string(node) +
                            R"(, "path": ")" + path + R"("}}], "samplers": [{"input": )" + std::to_string(input) +
                            R"(, "output": )" + std::to_string(output) + R"(, "interpolation": ")" + interpolation +
                            R"("}]})");
  }

  std::string bytes() const {
    return glb(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + nodes +
                   R"(, "meshes": [{"primitives": [)" + primitive + "]" + mesh_extra +
                   R"(}], "buffers": [{"byteLength": )" + std::to_string(buffer_.size()) + R"(}], "bufferViews": [)" +
                   views_ + R"(], "accessors": [)" + accessors_ + R"(], "animations": [)" + animations_ + "]" +
                   root_extra + "}",
               buffer_);
  }

 private:
  static void append(std::string& list, const std::string& entry) { list += (list.empty() ? "" : ", ") + entry; }
  std::string buffer_, views_, accessors_, animations_;
  size_t view_count_ = 0, accessor_count_ = 0, animation_count_ = 0;
};

const std::vector<float> kTriangle{0, 0, 0, 1, 0, 0, 0, 1, 0};

MovingGltf triangle() {
  MovingGltf file;
  file.add(kTriangle, "VEC3", 3);
  file.primitive = R"({"attributes": {"POSITION": 0}})";
  return file;
}

MeshInstant at(double time_s) { return {.take = "walk", .time_s = time_s, .frame_s = 0.1, .whole_take = true}; }

glm::vec3 vertexAt(const MovingGltf& file, double time_s, size_t vertex = 0) {
  const auto mesh = parseMesh(file.bytes(), "a.glb", at(time_s));
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  return mesh.ok() ? mesh.value().positions.at(vertex) : glm::vec3(NAN);
}

void expectNear(const glm::vec3& a, const glm::vec3& b) {
  EXPECT_LT(glm::distance(a, b), 1e-5) << a.x << " " << a.y << " " << a.z;
}

// Times are relative to the first key, which need not be 0.
TEST(GltfAnimation, NodesMoveLinearly) {
  MovingGltf file = triangle();
  file.animate("translation", {5, 6, 8}, {0, 0, 0, 2, 0, 0, 2, 4, 0}, "VEC3", 3);
  expectNear(vertexAt(file, 0), {0, 0, 0});
  expectNear(vertexAt(file, 0.25), {0.5, 0, 0});
  expectNear(vertexAt(file, 2), {2, 2, 0});
  expectNear(vertexAt(file, 3), {2, 4, 0});
  expectNear(vertexAt(file, 3.04), {2, 4, 0});
}

TEST(GltfAnimation, StepsHoldAndSplinesBend) {
  MovingGltf step = triangle();
  step.animate("scale", {0, 1, 2}, {1, 1, 1, 2, 1, 1, 3, 1, 1}, "VEC3", 3, "STEP");
  expectNear(vertexAt(step, 0.99, 1), {1, 0, 0});
  expectNear(vertexAt(step, 1, 1), {2, 0, 0});
  MovingGltf every_frame = triangle();
  std::vector<float> times, values;
  for (int f = 0; f < 20; ++f) {
    times.push_back(float(f) / 25);
    values.insert(values.end(), {float(f), 0, 0});
  }
  every_frame.animate("translation", times, values, "VEC3", 3, "STEP");
  for (int f = 0; f < 20; ++f) expectNear(vertexAt(every_frame, f / 25.0), {float(f), 0, 0});
  MovingGltf spline =
      triangle();  // tangent in, value, tangent out: leaves with speed 4, arrives at rest, in two seconds
  spline.animate("translation", {0, 2}, {9, 9, 9, 0, 0, 0, 4, 0, 0, 0, 0, 0, 2, 0, 0, 9, 9, 9}, "VEC3", 3,
                 "CUBICSPLINE");
  expectNear(vertexAt(spline, 0), {0, 0, 0});
  expectNear(vertexAt(spline, 1), {0.5 * 2 + 2 * 0.125 * 4, 0, 0});
  expectNear(vertexAt(spline, 2), {2, 0, 0});
}

// Shorter rotation, at constant speed.
TEST(GltfAnimation, TurnsGoTheShorterWay) {
  const float half = std::sqrt(0.5f);
  for (const float sign : {1.0f, -1.0f}) {
    MovingGltf file = triangle();
    file.animate("rotation", {0, 1}, {0, 0, 0, 1, 0, 0, sign * half, sign * half}, "VEC4", 4);
    expectNear(vertexAt(file, 1.0 / 3, 1), {std::cos(M_PI / 6), std::sin(M_PI / 6), 0});
    expectNear(vertexAt(file, 1, 1), {0, 1, 0});
  }
}

TEST(GltfAnimation, MorphTargetsAddUp) {
  MovingGltf file = triangle();
  const size_t a = file.add({0, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3", 3),
               b = file.add({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  file.primitive = R"({"attributes": {"POSITION": 0}, "targets": [{"POSITION": )" + std::to_string(a) +
                   R"(}, {"NORMAL": 0}, {"POSITION": )" + std::to_string(b) + "}]}";
  file.mesh_extra = R"(, "weights": [0.5, 0, 0])";
  expectNear(vertexAt(file, 0, 1), {2, 0, 0});
  file.nodes = R"([{"mesh": 0, "weights": [0, 0, 3]}])";
  expectNear(vertexAt(file, 0, 1), {1, 0, 3});
  file.animate("weights", {0, 1}, {0, 0, 0, 1, 0, 0.5}, "SCALAR", 1);
  expectNear(vertexAt(file, 0, 1), {1, 0, 0});
  expectNear(vertexAt(file, 0.5, 1), {2, 0, 0.25});
}

// Shapes of which few vertices move, as Blender writes them: two of three, on a base of zeros that is not stored.
TEST(GltfAnimation, SparseMorphTargets) {
  MovingGltf file = triangle();
  const size_t indices = file.addView(rawBytes(std::vector<uint16_t>{0, 2})),
               values = file.addView(rawBytes(std::vector<float>{0, 0, 7, 0, 0, 8}));
  const std::string sparse = R"(, "sparse": {"count": 2, "indices": {"componentType": 5123, "bufferView": )" +
                             std::to_string(indices) + R"(}, "values": {"bufferView": )" + std::to_string(values) +
                             "}}";
  const size_t target = file.describe("", "VEC3", 3, 5126, sparse);
  file.primitive = R"({"attributes": {"POSITION": 0}, "targets": [{"POSITION": )" + std::to_string(target) + "}]}";
  file.mesh_extra = R"(, "weights": [1])";
  expectNear(vertexAt(file, 0, 0), {0, 0, 7});
  expectNear(vertexAt(file, 0, 1), {1, 0, 0});
  expectNear(vertexAt(file, 0, 2), {0, 1, 8});
  for (const auto& [from, to] :
       {std::pair{"\"count\": 2,", "\"count\": 9,"}, std::pair{"\"count\": 3,", "\"count\": 9,"}}) {
    std::string broken = file.bytes();
    broken.replace(broken.find(from), std::string(from).size(), to);
    expectError(parseMesh(broken, "a.glb"), ErrorId::FileUnreadable, "a.glb: ");
  }
}

// Two joints: the second rotates about its own position, which the bind matrix subtracts. The mesh's own node transform
// is ignored.
MovingGltf skinned() {
  MovingGltf file = triangle();
  const size_t joints =
                   file.addRaw(rawBytes(std::vector<uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}), "VEC4", 3, 5121),
               weights = file.add({1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0}, "VEC4", 4),
               binds = file.add({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                "MAT4", 16);
  file.primitive = R"({"attributes": {"POSITION": 0, "JOINTS_0": )" + std::to_string(joints) + R"(, "WEIGHTS_0": )" +
                   std::to_string(weights) + "}}";
  file.nodes = R"([{"children": [1, 2]}, {"children": [3]}, {"mesh": 0, "skin": 0, "translation": [50, 0, 0]},
                   {"translation": [0, 1, 0]}])";
  file.root_extra = R"(, "skins": [{"joints": [1, 3], "inverseBindMatrices": )" + std::to_string(binds) + "}]";
  return file;
}

TEST(GltfAnimation, SkinsFollowTheirJoints) {
  MovingGltf file = skinned();
  expectNear(vertexAt(file, 0, 1), {1, 0, 0});  // bound as it is
  file.animate("rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4, "LINEAR", 3);
  const double turn = M_PI / 2;  // after half a second
  expectNear(vertexAt(file, 0.5, 0), {0, 0, 0});
  expectNear(vertexAt(file, 0.5, 1), {std::cos(turn) + 1, 1 + std::sin(turn), 0});
  expectNear(vertexAt(file, 0.5, 2), {0, 1, 0});
}

void expectMessage(const MovingGltf& file, ErrorId id, const std::string& words, const MeshInstant& instant = {}) {
  const auto mesh = parseMesh(file.bytes(), "a.glb", instant);
  expectError(mesh, id, "a.glb: ");
  if (!mesh.ok()) {
    EXPECT_NE(mesh.error().message.find(words), std::string::npos) << mesh.error().message;
    EXPECT_NE(mesh.error().message.find(";"), std::string::npos) << "no remedy: " << mesh.error().message;
  }
}

TEST(GltfAnimation, DamagedOnes) {
  const auto broken = [](const char* path, const std::vector<float>& times, const std::vector<float>& values,
                         const char* type, size_t width, int node, const char* words) {
    MovingGltf file = triangle();
    file.animate(path, times, values, type, width, "LINEAR", node);
    expectMessage(file, ErrorId::FileUnreadable, words);
  };
  broken("translation", {0, 1}, {0, 0, 0}, "VEC3", 3, 0, "keys");
  broken("translation", {1, 0}, {0, 0, 0, 1, 1, 1}, "VEC3", 3, 0, "out of order");
  broken("translation", {0, NAN}, {0, 0, 0, 1, 1, 1}, "VEC3", 3, 0, "out of order");
  broken("translation", {0, 1}, {0, 0, 0, 0, 1, 1, 1, 1}, "VEC4", 4, 0, "values cannot be read");
  broken("translation", {0, 1}, {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3}, "VEC3", 3, 0, "keys");
  broken("rotation", {0, 1}, {0, 0, 0, 1, 1, 1}, "VEC3", 3, 0, "values cannot be read");
  broken("translation", {0, 1}, {0, 0, 0, 1, 1, 1}, "VEC3", 3, 7, "missing");
  MovingGltf joint = skinned();
  joint.root_extra = R"(, "skins": [{"joints": [0]}])";
  expectMessage(joint, ErrorId::MeshIndex, "joint is out of range");
  joint.root_extra = R"(, "skins": [{"joints": [99, 0]}])";
  expectMessage(joint, ErrorId::FileUnreadable, "joint is not in the scene");
  joint.root_extra = "";
  expectMessage(joint, ErrorId::FileUnreadable, "a skin is missing");
  MovingGltf unweighted = skinned();
  unweighted.primitive = R"({"attributes": {"POSITION": 0}})";
  expectMessage(unweighted, ErrorId::Unsupported, "JOINTS_0");
  MovingGltf target = triangle();
  target.primitive = R"({"attributes": {"POSITION": 0}, "targets": [{"POSITION": )" +
                     std::to_string(target.add({0, 0, 0}, "VEC3", 3)) + "}]}";
  expectMessage(target, ErrorId::FileUnreadable, "morph target");
}

// If there are several, uses the animation with the take's name.
TEST(GltfAnimation, SeveralAnimationsAreChosenByName) {
  MovingGltf file = triangle();
  file.animate("translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", 3);
  file.animate("translation", {0, 1}, {0, 0, 0, 0, 1, 0}, "VEC3", 3);
  expectMessage(file, ErrorId::Unsupported, R"(has 2 animations ("clip0", "clip1"), none called "walk")", at(0));
  MeshInstant named = at(1);
  named.take = "clip1";
  const auto mesh = parseMesh(file.bytes(), "a.glb", named);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  expectNear(mesh.value().positions[0], {0, 1, 0});
}

TEST(GltfAnimation, LengthsMustFit) {
  MovingGltf file = triangle();
  expectMessage(file, ErrorId::VideoTooShort, "no animation that moves, but take \"walk\" goes on to 1 s", at(1));
  file.animate("translation", {3, 4}, {0, 0, 0, 1, 0, 0}, "VEC3", 3);
  expectMessage(file, ErrorId::VideoTooShort, "lasts 1 s, but take \"walk\" goes on to 1.1 s", at(1.1));
  MeshInstant one_frame{.take = "walk", .frame_s = 0.1};
  expectMessage(file, ErrorId::Unsupported, "the mesh of one frame, but its animation lasts 1 s", one_frame);
  one_frame.frame_s = 1;
  EXPECT_TRUE(parseMesh(file.bytes(), "a.glb", one_frame).ok())
      << "to the next frame: its first instant is the frame's";
}

// A quad with a UV seam: six vertices, four animated ones.
MovingGltf seamed() {
  MovingGltf file;
  file.add({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3);
  const size_t uvs = file.add({0, 1, .4f, 1, .4f, 0, .6f, 1, 1, 0, .6f, 0}, "VEC2", 2),
               target = file.add({0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", 3);
  file.primitive = R"({"attributes": {"POSITION": 0, "TEXCOORD_0": )" + std::to_string(uvs) +
                   R"(}, "targets": [{"POSITION": )" + std::to_string(target) + "}]}";
  file.animate("weights", {0, 2.0f / 25}, {0, 1}, "SCALAR", 1);
  return file;
}

TEST(GltfAnimation, ATakeOfConstantTopology) {
  SmallCapture files;
  files.remove("walk/mesh");
  files.write("walk/mesh/performance.glb", seamed().bytes());
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const MeshTopology& t = capture.value().topology;
  EXPECT_EQ(t.vertex_count, 4u);
  EXPECT_EQ(t.face_vertices, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(t.face_uvs, (std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(t.uvs.at(3), glm::vec2(.6f, 1));
  for (uint32_t f = 0; f < 3; ++f) {
    const auto positions = readMeshFrame(capture.value(), capture.value().sequences[0], f);
    ASSERT_TRUE(positions.ok()) << positions.error().message;
    expectNear(positions.value().at(1), {1 + 0.5 * f, 0, 0});
  }
  files.write("capture.json", std::string(R"({"fps": 25, "sequences": [{"name": "walk", "frames": 4}]})"));
  expectError(files.open(), ErrorId::VideoTooShort, files / "walk/mesh/performance.glb");
}

TEST(GltfAnimation, ATakeOfPerFrameTopology) {
  BareCapture files("per-frame", R"(, "first_frame": 1, "mesh": "scans/all.glb")", "centimetre");
  MovingGltf file = triangle();
  file.animate("translation", {1, 2}, {0, 0, 0, 25, 0, 0}, "VEC3", 3);
  files.write("scans/all.glb", file.bytes());
  const auto capture = files.openAs(MeshNeed::AnySurface);
  ASSERT_FALSE(capture.ok()) << "pictures begin with number 1, and end before number 3";
  files.declare("per-frame", R"(, "mesh": "scans/all.glb")", "centimetre");
  const auto whole = files.openAs(MeshNeed::AnySurface);
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  const auto mesh = readSurfaceFrame(whole.value(), whole.value().sequences[0], 2);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  expectNear(mesh.value().positions.at(1), {0.03, 0, 0});
}

TEST(GltfAnimation, ConstantTopologyNeedsUvs) {
  SmallCapture files;
  files.remove("walk/mesh");
  MovingGltf file = triangle();
  file.animate("translation", {0, 2}, {0, 0, 0, 1, 0, 0}, "VEC3", 3);
  files.write("walk/mesh/a.glb", file.bytes());
  expectError(files.open(), ErrorId::MeshNoUvs, files / "walk/mesh/a.glb");
}

}  // namespace
}  // namespace fourdvt::capture
