// SPDX-License-Identifier: Apache-2.0
// Tracking: one mesh through the surfaces of a person who stands and walks, an interrupted run, and surfaces that
// cannot be tracked.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/mesh.h"
#include "capture/capture.h"
#include "capture/mesh_file.h"
#include "command.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

const std::string kFaces = " --faces 2500";

// Surfaces of five frames of the studio's actor, made once.
const std::string& surfaces() {
  static const std::string folder = [] {
    const std::string out = scratch("track-surfaces");
    const Outcome studio =
        lab("studio procedural --sequences walk --frames 5 --no-truth --test-every 8 --mesh-cell-mm 45 --cameras 6 "
            "--size 240x320 -o " +
            out + "/capture");
    EXPECT_EQ(studio.code, 0) << studio.output;
    const Outcome made = fourdvt("reconstruct " + out + "/capture -o " + out +
                                 "/surfaces --synchronise off --refine-cameras off --refine none --voxel-mm 10");
    EXPECT_EQ(made.code, 0) << made.output;
    return out;
  }();
  return folder;
}

// Copy of the surfaces whose meshes can be changed.
std::string ownSurfaces(const std::string& name) {
  const std::string copy = surfaces() + "/" + name;
  fs::remove_all(copy);
  fs::copy(surfaces() + "/surfaces", copy, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  return copy;
}

// capture.json without its meshes.
std::string withoutMeshKeys(const std::string& json) {
  auto capture = nlohmann::json::parse(json);
  for (auto& sequence : capture["sequences"]) sequence.erase("mesh");
  return capture.dump();
}

// The report has the seconds of each run.
std::vector<std::string> without(const std::string& name, std::vector<std::string> names) {
  std::erase(names, name);
  return names;
}

template <class Change>
void changeMeshes(const std::string& folder, size_t first, Change change) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder + "/walk/mesh")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (size_t f = first; f < files.size(); ++f) {
    auto mesh = capture::readMeshFile(files[f]);
    ASSERT_TRUE(mesh.ok());
    TriangleMesh changed = mesh.take();
    change(changed);
    ASSERT_TRUE(platform::writeFileAtomic(files[f], capture::plyBytes(changed)).ok());
  }
}

void expectRefusal(const Outcome& outcome, const std::string& text, const std::string& folder) {
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find(text), std::string::npos) << outcome.output;
  EXPECT_FALSE(exists(folder));
}

TEST(Track, MakesACaptureThatBakesIntoLayers) {
  const std::string out = surfaces() + "/tracked";
  const Outcome tracked = fourdvt("track " + surfaces() + "/surfaces -o " + out + kFaces);
  ASSERT_EQ(tracked.code, 0) << tracked.output;
  for (const char* file : {"/mesh_topology.obj", "/walk/mesh/positions.i16", "/track.html", "/track-1.jpg"})
    EXPECT_TRUE(exists(out + file)) << file;
  EXPECT_FALSE(exists(out + ".work"));
  const auto report = nlohmann::json::parse(readText(out + "/track.json"));
  EXPECT_GT(report["mean_overlap"].get<double>(), 0.9);
  EXPECT_NEAR(report["faces"].get<double>(), 2500, 50);

  const Outcome drift =
      lab("drift " + out + " --reference " + surfaces() + "/capture --within-mm 40 --json " + out + "/drift.json");
  EXPECT_EQ(drift.code, 0) << drift.output;

  const Outcome bake = fourdvt("bake " + out + " -o " + surfaces() +
                               "/character --texture 128 --layers 2 --gop 4 --jobs 2 "
                               "--align none --renditions highest --refine none --refine-cameras off");
  EXPECT_EQ(bake.code, 0) << bake.output;
  EXPECT_EQ(fourdvt("inspect " + surfaces() + "/character").code, 0);
}

// A clip of more than one stride through the room becomes a loop of one: pictures, mattes and positions stay in step,
// and the bake shows it on the spot.
TEST(Track, MakesALoopOfOneStride) {
  const std::string out = scratch("track-loop");
  const Outcome studio = lab(
      "studio procedural --sequences walk --strides 1.2 --travel --fps 8 --no-truth --test-every 4 --mesh-cell-mm 45 "
      "--cameras 6 --size 240x320 -o " +
      out + "/capture");
  ASSERT_EQ(studio.code, 0) << studio.output;
  const Outcome tracked = fourdvt("track " + out + "/capture -o " + out + "/tracked --loop walk" + kFaces);
  ASSERT_EQ(tracked.code, 0) << tracked.output;
  EXPECT_NE(tracked.output.find("are a loop"), std::string::npos) << tracked.output;
  const auto walk = nlohmann::json::parse(readText(out + "/tracked/capture.json"))["sequences"][0];
  EXPECT_EQ(walk["frames"], 9);  // 1.12 s at 8 frames a second
  EXPECT_TRUE(walk["loop"].get<bool>());
  const auto report = nlohmann::json::parse(readText(out + "/tracked/track.json"))["loops"]["walk"];
  const uint32_t first = walk.value("first_frame", 0u);
  EXPECT_EQ(report["first_frame"], first);
  EXPECT_LT(report["misfit_share"].get<double>(), 0.2);

  const auto loop = capture::openDescription(out + "/tracked", {}, capture::MeshNeed::ConstantTopology);
  const auto given = capture::openDescription(out + "/capture", {}, capture::MeshNeed::ConstantTopology);
  ASSERT_TRUE(loop.ok() && given.ok());
  for (uint32_t f = 0; f < 9; ++f) {
    const auto mesh = capture::readMeshFrame(loop.value(), loop.value().sequences[0], f);
    const auto shown = capture::readMeshFrame(given.value(), given.value().sequences[0], first + f);
    ASSERT_TRUE(mesh.ok() && shown.ok());
    const BoundingBox box = boundsOf(mesh.value()), wanted = boundsOf(shown.value());
    EXPECT_LT(glm::distance(box.min, wanted.min) + glm::distance(box.max, wanted.max), 0.08) << f;
  }
  EXPECT_NEAR(walk["root_velocity"][2].get<double>(), 0.95, 0.03);  // the studio's walk
  EXPECT_NEAR(walk["travel"]["shift"][1].get<double>(), 0.95 * 9 / 8, 0.04);

  const std::string bake = "bake " + out + "/tracked -o " + out + "/character";
  expectRefusal(fourdvt(bake + " --appearance cameras"), "\"travel\" of \"walk\"", out + "/character");
  const Outcome baked = fourdvt(bake +
                                " --texture 128 --layers 2 --gop 4 --jobs 2 --align none --renditions highest "
                                "--refine none --refine-cameras off");
  ASSERT_EQ(baked.code, 0) << baked.output;
  EXPECT_EQ(fourdvt("inspect " + out + "/character").code, 0);
  for (uint32_t f = 0; f < 9; ++f) {
    const auto placed = capture::readMeshFrameInPlace(loop.value(), loop.value().sequences[0], f);
    ASSERT_TRUE(placed.ok());
    const BoundingBox box = boundsOf(placed.value());
    EXPECT_LT(std::max(std::abs(box.min.z), std::abs(box.max.z)), 0.6) << f;  // half a step of the feet
  }
}

TEST(Track, GoesOnAfterAnInterruption) {
  const std::string out = scratch("track-interrupted"), options = "track " + surfaces() + "/surfaces " + kFaces;
  ASSERT_EQ(fourdvt(options + " -o " + out + "/straight").code, 0);
  const Outcome stop =
      interrupted(FOURDVT_BIN, options + " -o " + out + "/stopped", out + "/stopped.work", out + "/log");
  ASSERT_EQ(stop.code, 130) << stop.output;
  EXPECT_NE(stop.output.find("--resume"), std::string::npos) << stop.output;
  EXPECT_FALSE(exists(out + "/stopped"));
  const Outcome resumed = fourdvt(options + " -o " + out + "/stopped --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_EQ(differences(out + "/straight/walk/mesh", out + "/stopped/walk/mesh"), std::vector<std::string>{});
}

nlohmann::json piecesOf(const std::string& job) {
  return nlohmann::json::parse(readText(job + "/plan.json"))["pieces"];
}

// Two branches begin at the template's frame. One piece is killed, one computed twice at once, as is the result.
TEST(Track, InPiecesGivesTheBytesOfOneRun) {
  const std::string given = ownSurfaces("in-pieces"), out = scratch("track-pieces");
  const std::string options = given + kFaces + " --template walk:2 -o " + out;
  const std::string target = out + "/target", job = target + ".work";
  const Outcome planned = fourdvt("plan track " + options + "/target");
  ASSERT_EQ(planned.code, 0) << planned.output;
  const nlohmann::json pieces = piecesOf(job);
  std::vector<std::string> ids;
  for (const auto& piece : pieces) ids.push_back(piece["id"]);
  ASSERT_EQ(ids.size(), 3u);
  EXPECT_EQ(ids[0], "fits-walk-2");
  EXPECT_EQ(ids[2], "finish");
  const Outcome early = fourdvt("piece " + job + " " + ids[1]);
  EXPECT_EQ(early.code, 1);
  EXPECT_NE(early.output.find("needs fits-walk-2"), std::string::npos) << early.output;

  const std::string piece = std::string(FOURDVT_BIN) + " piece " + job + " ";
  const std::string fits = job + "/*/fits/walk";
  shell(piece + ids[0] + " & piece=$!; while ! ls " + fits + " | grep -q bin; do :; done; kill -9 $piece; wait $piece");
  EXPECT_FALSE(exists(job + "/" + pieces[0]["done"].get<std::string>()));
  ASSERT_EQ(fourdvt("piece " + job + " " + ids[0]).code, 0);

  const std::string mesh = given + "/walk/mesh/" + (ids[1] == "fits-walk-1" ? "000001.ply" : "000003.ply");
  const auto time = fs::last_write_time(mesh);
  fs::last_write_time(mesh, time + std::chrono::seconds(5));
  const Outcome changed = fourdvt("piece " + job + " " + ids[1]);
  EXPECT_TRUE(isOneLineWith(changed, given + "/walk: files of frame " + ids[1].back() + " have changed since the plan"))
      << changed.output;
  fs::last_write_time(mesh, time);
  const Outcome both =
      shell(piece + ids[1] + " & first=$!; " + piece + ids[1] + "; second=$?; wait $first && exit $second");
  ASSERT_EQ(both.code, 0) << both.output;

  const std::string finish = std::string(FOURDVT_BIN) + " finish " + job;
  const Outcome finished = shell(finish + " & first=$!; " + finish + "; second=$?; wait $first && exit $second");
  ASSERT_EQ(finished.code, 0) << finished.output;
  EXPECT_TRUE(exists(target + "/track.html") && exists(job + "/job.html"));
  for (const auto& entry : fs::directory_iterator(out))
    EXPECT_EQ(entry.path().filename().string().find(".part"), std::string::npos) << entry.path();
  EXPECT_EQ(nlohmann::json::parse(readText(job + "/job.json"))["over_memory"], nlohmann::json::array());
  const std::string result = out + "/result";
  fs::rename(target, result);

  // The single process continues from the finished pieces; then it begins anew.
  const Outcome resumed = fourdvt("track " + options + "/target --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_FALSE(exists(job));
  EXPECT_EQ(without("track.html", differences(result, target)), std::vector<std::string>{});
  ASSERT_EQ(fourdvt("track " + options + "/straight").code, 0);
  EXPECT_EQ(without("track.html", differences(result, out + "/straight")), std::vector<std::string>{});
}

TEST(Track, RefusesWhatItCannotFollow) {
  const std::string out = scratch("track-refused") + "/tracked", track = "track ", to = " -o " + out + kFaces;
  std::string capture = surfaces() + "/meshless";
  fs::copy(surfaces() + "/capture", capture, fs::copy_options::recursive);
  fs::remove_all(capture + "/walk/mesh");
  const std::string json = readText(capture + "/capture.json");
  writeText(capture + "/capture.json", withoutMeshKeys(json));
  expectRefusal(fourdvt(track + capture + to), "fourdvt reconstruct", out);
  expectRefusal(fourdvt(track + surfaces() + "/surfaces --template walk:400" + to), "no such frame", out);

  expectRefusal(fourdvt(track + surfaces() + "/surfaces --loop nowhere" + to), "no sequence \"nowhere\"", out);
  expectRefusal(fourdvt(track + surfaces() + "/surfaces --loop walk" + to), "too few for a cycle", out);
  expectRefusal(fourdvt(track + surfaces() + "/surfaces --class go:speed_mps=walk,nowhere" + to), "nowhere", out);

  const std::string shifted = ownSurfaces("shifted");
  changeMeshes(shifted, 0, [](TriangleMesh& mesh) {
    for (glm::vec3& p : mesh.positions) p.x += 0.5f;
  });
  expectRefusal(fourdvt(track + shifted + to), "was not made of these pictures", out);

  const std::string two = ownSurfaces("two");
  changeMeshes(two, 0, [](TriangleMesh& mesh) {
    const auto count = uint32_t(mesh.positions.size());
    const size_t faces = mesh.faces.size();
    for (uint32_t v = 0; v < count; ++v) mesh.positions.push_back(mesh.positions[v] + glm::vec3(1.5f, 0, 0));
    for (size_t f = 0; f < faces; ++f) mesh.faces.push_back(mesh.faces[f] + count);
  });
  expectRefusal(fourdvt(track + two + to), "follows one performer", out);

  // A part that was put down: the surfaces of later frames lie elsewhere.
  const std::string changed = ownSurfaces("changed");
  changeMeshes(changed, 2, [](TriangleMesh& mesh) {
    for (glm::vec3& p : mesh.positions) p.y = 0.5f * p.y;
  });
  const Outcome outcome = fourdvt(track + changed + " --template walk:0" + to);
  expectRefusal(outcome, "is another mesh", out);
}

}  // namespace
}  // namespace fourdvt::test
