// SPDX-License-Identifier: Apache-2.0
// Reconstruction: surfaces from cameras alone, an interrupted run, pieces, and invalid captures.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "capture/mesh_file.h"
#include "command.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

const std::string kCoarse = " --voxel-mm 20 --refine none";

// Capture with pictures and mattes, without meshes or a declaration of them.
std::string withoutMeshes(const std::string& name, int frames = 3) {
  const std::string capture = smallCapture(name, frames);
  for (const auto& entry : fs::directory_iterator(capture))
    if (entry.is_directory()) fs::remove_all(entry.path() / "mesh");
  return capture;
}

void expectFailure(const Outcome& outcome, const std::string& named, const std::string& folder) {
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  const size_t at = outcome.output.find("fourdvt: ");
  ASSERT_NE(at, std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find(named, at), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find('\n', at), outcome.output.size() - 1) << outcome.output;
  EXPECT_FALSE(exists(folder));
}

// Overwrites the matte of one camera and frame with a constant value.
void fillMatte(const std::string& capture, const std::string& camera, const std::string& frame, uint8_t value) {
  const std::string path = capture + "/turn/mask" + camera + "/" + frame + ".png";
  const auto matte = platform::readImage(path);
  ASSERT_TRUE(matte.ok());
  ASSERT_TRUE(platform::writeImage(path, Image(matte.value().width, matte.value().height, 3, value)).ok());
}

// Moves the performer in a matte to where no other camera sees one.
void contradict(const std::string& capture, const std::string& camera, const std::string& frame) {
  const std::string path = capture + "/turn/mask" + camera + "/" + frame + ".png";
  const auto matte = platform::readImage(path);
  ASSERT_TRUE(matte.ok());
  Image odd(matte.value().width, matte.value().height, 3, 0);
  for (int y = 2; y < 8; ++y)
    for (int x = 2; x < 8; ++x) odd.at(x, y)[0] = odd.at(x, y)[1] = odd.at(x, y)[2] = 255;
  ASSERT_TRUE(platform::writeImage(path, odd).ok());
}

TEST(Reconstruct, MakesACaptureThatCanBeScored) {
  const std::string capture = withoutMeshes("meshless-capture"), out = scratch("reconstructed");
  const Outcome made = fourdvt("reconstruct " + capture + " -o " + out + "/hull" + kCoarse);
  ASSERT_EQ(made.code, 0) << made.output;
  EXPECT_FALSE(exists(out + "/hull.work") || exists(out + "/hull.part"));
  for (const char* file : {"/capture.json", "/reconstruct.json", "/reconstruct.html", "/reconstruct-1.jpg",
                           "/turn/mesh/000000.ply", "/turn/mesh/000002.ply", "/cameras/images.txt"})
    EXPECT_TRUE(exists(out + "/hull" + file)) << file;
  EXPECT_FALSE(exists(out + "/hull/turn/mesh/000003.ply"));
  EXPECT_TRUE(fs::is_symlink(out + "/hull/cameras"));
  EXPECT_NE(readText(out + "/hull/capture.json").find("\"topology\": \"per-frame\""), std::string::npos);

  const std::string given = smallCapture("meshed-capture", 3);
  const Outcome score = lab("surfaces " + out + "/hull --reference " + given);
  EXPECT_EQ(score.code, 0) << score.output;
  EXPECT_NE(score.output.find("turn"), std::string::npos) << score.output;
  const Outcome drift =
      lab("drift " + given + " --reference " + given + " --frame turn:1 --json " + out + "/drift.json");
  EXPECT_EQ(drift.code, 0) << drift.output;
  EXPECT_EQ(nlohmann::json::parse(readText(out + "/drift.json"))["all"]["max_mm"], 0.0);

  const Outcome again = fourdvt("reconstruct " + out + "/hull -o " + out + "/again" + kCoarse);
  EXPECT_EQ(again.code, 0) << again.output;
  for (const char* file : {"/reconstruct.json", "/reconstruct.html", "/reconstruct-1.jpg"})
    EXPECT_FALSE(fs::is_symlink(out + "/again" + file)) << file << " would be written into the other folder";
  EXPECT_EQ(readText(out + "/again/turn/mesh/000001.ply"), readText(out + "/hull/turn/mesh/000001.ply"));
}

TEST(Reconstruct, PolyhedralHullsHaveFarFewerTriangles) {
  const std::string capture = withoutMeshes("polyhedral-capture", 1), out = scratch("polyhedral");
  const Outcome made = fourdvt("reconstruct " + capture + " -o " + out + "/hull --hull polyhedral");
  ASSERT_EQ(made.code, 0) << made.output;
  EXPECT_NE(readText(out + "/hull/reconstruct.json").find("\"fallback\": \"\""), std::string::npos);
  EXPECT_LT(fs::file_size(out + "/hull/turn/mesh/000000.ply"), 20000u);
}

TEST(Reconstruct, StereoRefinesTheHullUnlessAskedNotTo) {
  const std::string capture = withoutMeshes("stereo-capture", 2), out = scratch("stereo");
  const Outcome made = fourdvt("reconstruct " + capture + " -o " + out + "/refined --voxel-mm 20");
  ASSERT_EQ(made.code, 0) << made.output;
  EXPECT_NE(readText(out + "/refined/reconstruct.json").find("\"refine\": \"stereo\""), std::string::npos);
  ASSERT_EQ(fourdvt("reconstruct " + capture + " -o " + out + "/hull" + kCoarse).code, 0);
  const auto refined = capture::readMeshFile(out + "/refined/turn/mesh/000001.ply");
  const auto hull = capture::readMeshFile(out + "/hull/turn/mesh/000001.ply");
  ASSERT_TRUE(refined.ok() && hull.ok());
  EXPECT_GT(refined.value().faces.size(), 100u);
  EXPECT_NE(refined.value().positions, hull.value().positions);

  const Outcome both = fourdvt("reconstruct " + capture + " -o " + out + "/both --hull polyhedral --refine stereo");
  EXPECT_EQ(both.code, 2);
  EXPECT_NE(both.output.find("--hull polyhedral"), std::string::npos) << both.output;
}

TEST(Reconstruct, ResumeWithOtherOptionsIsRefusedAndKeepsTheFrames) {
  const std::string capture = withoutMeshes("resume-capture", 24), out = scratch("resume-other");
  const std::string target = out + "/hull";
  const Outcome stop =
      interrupted(FOURDVT_BIN, "reconstruct " + capture + " -o " + target + " --voxel-mm 8 --refine none",
                  target + ".part/turn/mesh/000001.ply", out + "/log");
  ASSERT_EQ(stop.code, 130) << stop.output;
  const Outcome other = fourdvt("reconstruct " + capture + " -o " + target + " --voxel-mm 9 --refine none --resume");
  expectFailure(other, "other options", target);
  EXPECT_TRUE(exists(target + ".part/turn/mesh/000000.ply"));
}

TEST(Reconstruct, MeshesAreInTheCapturesUnit) {
  const std::string capture = withoutMeshes("unit-capture", 1), out = scratch("units");
  ASSERT_EQ(fourdvt("reconstruct " + capture + " -o " + out + "/metres" + kCoarse).code, 0);
  std::string json = readText(capture + "/capture.json");
  const size_t at = json.find("\"metre\"");
  ASSERT_NE(at, std::string::npos) << json;
  writeText(capture + "/capture.json", json.replace(at, 7, "\"centimetre\""));
  // Writes the same rig in centimetres.
  std::istringstream lines(readText(capture + "/cameras/images.txt"));
  std::string line, scaled;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string id, q[4], camera, name;
    double t[3];
    if (line.starts_with("#") ||
        !(fields >> id >> q[0] >> q[1] >> q[2] >> q[3] >> t[0] >> t[1] >> t[2] >> camera >> name)) {
      scaled += line + "\n";
      continue;
    }
    std::ostringstream text;
    text.precision(17);
    text << id << ' ' << q[0] << ' ' << q[1] << ' ' << q[2] << ' ' << q[3] << ' ' << 100 * t[0] << ' ' << 100 * t[1]
         << ' ' << 100 * t[2] << ' ' << camera << ' ' << name << '\n';
    scaled += text.str();
  }
  writeText(capture + "/cameras/images.txt", scaled);
  const Outcome made = fourdvt("reconstruct " + capture + " -o " + out + "/centimetres" + kCoarse);
  ASSERT_EQ(made.code, 0) << made.output;
  const auto metres = capture::readMeshFile(out + "/metres/turn/mesh/000000.ply");
  const auto centimetres = capture::readMeshFile(out + "/centimetres/turn/mesh/000000.ply");
  ASSERT_TRUE(metres.ok() && centimetres.ok());
  ASSERT_EQ(metres.value().positions.size(), centimetres.value().positions.size());
  for (size_t v = 0; v < metres.value().positions.size(); ++v)
    EXPECT_LT(glm::distance(100.0f * metres.value().positions[v], centimetres.value().positions[v]), 0.01f);
}

TEST(Reconstruct, BakeSaysWhatToRunFirst) {
  const std::string capture = withoutMeshes("unbakeable-capture"), out = scratch("unbakeable");
  expectFailure(fourdvt("bake " + capture + " -o " + out + "/box"), "fourdvt reconstruct", out + "/box");
}

TEST(Reconstruct, InterruptedResumesToTheSameBytes) {
  const std::string capture = withoutMeshes("long-meshless", 24), out = scratch("reconstruct-resume");
  const std::string options = " --voxel-mm 8 --refine none";
  ASSERT_EQ(fourdvt("reconstruct " + capture + " -o " + out + "/straight" + options).code, 0);
  const std::string stopped = out + "/stopped";
  const Outcome stop = interrupted(FOURDVT_BIN, "reconstruct " + capture + " -o " + stopped + options,
                                   stopped + ".part/turn/mesh/000001.ply", out + "/log");
  ASSERT_EQ(stop.code, 130) << stop.output;
  EXPECT_FALSE(exists(stopped));
  EXPECT_NE(stop.output.find("--resume"), std::string::npos);

  const Outcome resumed = fourdvt("reconstruct " + capture + " -o " + stopped + options + " --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_EQ(readText(stopped + "/reconstruct.json").find("\"frames_of_an_earlier_run\": 0"), std::string::npos);
  EXPECT_EQ(differences(out + "/straight/turn/mesh", stopped + "/turn/mesh"), std::vector<std::string>{});
}

// All pieces of a plan but the last, to be run in separate processes.
std::vector<std::string> piecesOf(const std::string& job) {
  std::vector<std::string> out;
  const auto plan = nlohmann::json::parse(readText(job + "/plan.json"));
  for (const auto& piece : plan["pieces"])
    if (piece["kind"] != "finish") out.push_back(piece["id"]);
  return out;
}

std::string doneFile(const std::string& job, const std::string& id) {
  const auto plan = nlohmann::json::parse(readText(job + "/plan.json"));
  for (const auto& piece : plan["pieces"])
    if (piece["id"] == id) return job + "/" + piece["done"].get<std::string>();
  return {};
}

void computePieces(const std::string& job) {
  for (const std::string& id : piecesOf(job)) {
    const Outcome computed = fourdvt("piece " + job + " " + id);
    ASSERT_EQ(computed.code, 0) << id << ": " << computed.output;
  }
}

void expectSameResult(const std::string& a, const std::string& b) {
  EXPECT_EQ(differences(a + "/turn/mesh", b + "/turn/mesh"), std::vector<std::string>{});
  EXPECT_EQ(readText(a + "/capture.json"), readText(b + "/capture.json"));
}

// Capture of two windows, and its result in one run.
struct TwoWindows {
  std::string capture = withoutMeshes("pieces-capture", 35), straight = scratch("pieces-straight") + "/hull";
  TwoWindows() { EXPECT_EQ(fourdvt("reconstruct " + capture + " -o " + straight + kCoarse).code, 0); }
};
const TwoWindows& twoWindows() {
  static const TwoWindows made;
  return made;
}

// The second window's frames do not depend on the first's; two processes that compute them write the same bytes.
TEST(ReconstructInPieces, GivesTheBytesOfOneRun) {
  const std::string capture = twoWindows().capture, target = scratch("pieces") + "/target", job = target + ".work";
  const Outcome planned = fourdvt("plan reconstruct " + capture + " -o " + target + kCoarse);
  ASSERT_EQ(planned.code, 0) << planned.output;
  EXPECT_EQ(piecesOf(job), (std::vector<std::string>{"first-turn", "frames-turn-0", "frames-turn-1"}));
  const Outcome early = fourdvt("piece " + job + " frames-turn-1");
  EXPECT_EQ(early.code, 1);
  EXPECT_NE(early.output.find("needs first-turn"), std::string::npos) << early.output;
  EXPECT_EQ(fourdvt("finish " + job).code, 1);

  ASSERT_EQ(fourdvt("piece " + job + " first-turn").code, 0);
  EXPECT_TRUE(exists(target + ".part/turn/mesh/000000.ply"));
  EXPECT_FALSE(exists(target + ".part/turn/mesh/000001.ply"));
  const std::string second = std::string(FOURDVT_BIN) + " piece " + job + " frames-turn-1";
  const Outcome both = shell("( " + second + " & " + second + " && wait )");
  ASSERT_EQ(both.code, 0) << both.output;
  EXPECT_FALSE(exists(target + ".part/turn/mesh/000001.ply"));
  computePieces(job);
  const std::string finish = std::string(FOURDVT_BIN) + " finish " + job;
  const Outcome finished = shell(finish + " & first=$!; " + finish + "; second=$?; wait $first && exit $second");
  ASSERT_EQ(finished.code, 0) << finished.output;
  EXPECT_TRUE(exists(target + "/reconstruct.html") && exists(target + "/reconstruct-1.jpg"));
  EXPECT_TRUE(exists(job + "/job.html") && !exists(target + ".part"));
  expectSameResult(twoWindows().straight, target);
  // A process may be killed between both steps.
  ASSERT_TRUE(fs::remove(doneFile(job, "finish")));
  const Outcome recorded = fourdvt("finish " + job);
  EXPECT_EQ(recorded.code, 0) << recorded.output;
  EXPECT_TRUE(exists(doneFile(job, "finish")));

  // The frames are in the result now; a new plan starts the job anew.
  ASSERT_EQ(fourdvt("plan reconstruct " + capture + " -o " + target + kCoarse).code, 0);
  EXPECT_FALSE(exists(doneFile(job, "frames-turn-1")) || exists(doneFile(job, "finish")));
}

TEST(ReconstructInPieces, StereoMakesAWindowFromItsStart) {
  const std::string capture = withoutMeshes("stereo-pieces-capture", 3), out = scratch("stereo-pieces");
  const std::string options = " --voxel-mm 20 --planes 16", target = out + "/target", job = target + ".work";
  ASSERT_EQ(fourdvt("reconstruct " + capture + " -o " + out + "/straight" + options).code, 0);
  ASSERT_EQ(fourdvt("plan reconstruct " + capture + " -o " + target + options).code, 0);
  computePieces(job);
  // A missing frame.
  fs::remove(target + ".part/turn/mesh/000002.ply");
  const Outcome lacking = fourdvt("finish " + job);
  EXPECT_EQ(lacking.code, 1);
  EXPECT_NE(lacking.output.find("frame 2"), std::string::npos) << lacking.output;
  ASSERT_EQ(fourdvt("plan reconstruct " + capture + " -o " + target + options).code, 0);
  EXPECT_TRUE(exists(doneFile(job, "first-turn")));
  EXPECT_FALSE(exists(doneFile(job, "frames-turn-0")));
  computePieces(job);
  ASSERT_EQ(fourdvt("finish " + job).code, 0);
  expectSameResult(out + "/straight", target);
}

TEST(ReconstructInPieces, FilesThatHaveChangedAreRefused) {
  const std::string capture = withoutMeshes("changed-capture", 34), out = scratch("changed-pieces");
  const std::string plan = "plan reconstruct " + capture + " -o " + out + "/hull" + kCoarse, job = out + "/hull.work";
  ASSERT_EQ(fourdvt(plan).code, 0);
  std::string picture;
  for (const auto& entry : fs::recursive_directory_iterator(capture + "/turn"))
    if (entry.path().filename() == "000033.png") picture = entry.path().string();
  ASSERT_FALSE(picture.empty());
  fs::last_write_time(picture, fs::last_write_time(picture) + std::chrono::seconds(5));
  EXPECT_EQ(fourdvt("piece " + job + " first-turn").code, 0);
  const Outcome refused = fourdvt("piece " + job + " frames-turn-1");
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.output.find("files of frames 32 to 33 have changed since the plan was made"), std::string::npos)
      << refused.output;
  const Outcome again = fourdvt(plan);
  ASSERT_EQ(again.code, 0) << again.output;
  EXPECT_NE(again.output.find("all begins again"), std::string::npos) << again.output;
  computePieces(job);
  EXPECT_EQ(fourdvt("finish " + job).code, 0);
}

// Prevents mixing results of two builds: a key of the plan contains the build.
TEST(ReconstructInPieces, FolderOfAnotherBuildBeginsAgain) {
  const std::string capture = withoutMeshes("build-capture"), out = scratch("build-pieces");
  const std::string plan = "plan reconstruct " + capture + " -o " + out + "/hull" + kCoarse, job = out + "/hull.work";
  ASSERT_EQ(fourdvt(plan).code, 0);
  ASSERT_EQ(fourdvt("piece " + job + " first-turn").code, 0);
  ASSERT_EQ(fourdvt(plan).code, 0);
  EXPECT_TRUE(exists(doneFile(job, "first-turn"))) << "a plan of the same keeps what is done";
  const std::string text = readText(job + "/settings.txt");
  const size_t build = text.find("build ");
  ASSERT_NE(build, std::string::npos) << text;
  writeText(job + "/settings.txt", text.substr(0, build) + "build 0123456789abcdef\nby reconstruct\n");
  const Outcome stale = fourdvt("piece " + job + " frames-turn-0");
  EXPECT_EQ(stale.code, 1);
  EXPECT_NE(stale.output.find("belongs to a run with other settings now"), std::string::npos) << stale.output;
  EXPECT_FALSE(exists(out + "/hull.part/turn/mesh/000001.ply"));
  const Outcome again = fourdvt(plan);
  EXPECT_NE(again.output.find("all begins again"), std::string::npos) << again.output;
  EXPECT_FALSE(exists(doneFile(job, "first-turn")) || exists(out + "/hull.part/turn/mesh/000000.ply"));
}

TEST(ReconstructInPieces, ResumeGoesOnWithPiecesAndPiecesWithARun) {
  const std::string capture = twoWindows().capture, straight = twoWindows().straight, out = scratch("both-ways");

  const std::string resumed = out + "/resumed";
  ASSERT_EQ(fourdvt("plan reconstruct " + capture + " -o " + resumed + kCoarse).code, 0);
  ASSERT_EQ(fourdvt("piece " + resumed + ".work first-turn").code, 0);
  ASSERT_EQ(fourdvt("piece " + resumed + ".work frames-turn-1").code, 0);
  const Outcome run = fourdvt("reconstruct " + capture + " -o " + resumed + kCoarse + " --resume");
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_NE(readText(resumed + "/reconstruct.json").find("\"frames_of_an_earlier_run\": 4,"), std::string::npos);
  expectSameResult(straight, resumed);

  const std::string stopped = out + "/stopped", frame = stopped + ".part/turn/mesh/000001.ply";
  ASSERT_EQ(interrupted(FOURDVT_BIN, "reconstruct " + capture + " -o " + stopped + kCoarse, frame, out + "/log").code,
            130);
  const auto made = fs::last_write_time(frame);
  ASSERT_EQ(fourdvt("plan reconstruct " + capture + " -o " + stopped + kCoarse).code, 0);
  computePieces(stopped + ".work");
  EXPECT_EQ(fs::last_write_time(frame), made);
  ASSERT_EQ(fourdvt("finish " + stopped + ".work").code, 0);
  expectSameResult(straight, stopped);
}

// Only two cameras have a silhouette in the first frame, which cannot contradict each other; each window is judged
// separately.
TEST(ReconstructInPieces, SilhouettesAreJudgedAsInOneRun) {
  const std::string capture = withoutMeshes("judged-capture", 34), out = scratch("judged"), job = out + "/hull.work";
  for (const auto& entry : fs::directory_iterator(capture + "/turn"))
    if (const std::string name = entry.path().filename().string(); name.rfind("mask", 0) == 0 && name > "mask01")
      fillMatte(capture, name.substr(4), "000000", 0);
  const std::string command = "reconstruct " + capture + " -o " + out + "/hull" + kCoarse;
  contradict(capture, "02", "000032");
  const Outcome whole = fourdvt(command);
  expectFailure(whole, "frame 32", out + "/hull");
  EXPECT_NE(whole.output.find("frame 32: the silhouette of camera \"cam02\" does not fit"), std::string::npos)
      << whole.output;
  ASSERT_EQ(fourdvt("plan " + command).code, 0);
  ASSERT_EQ(fourdvt("piece " + job + " first-turn").code, 0);
  const Outcome piece = fourdvt("piece " + job + " frames-turn-1");
  EXPECT_EQ(piece.code, 1);
  EXPECT_NE(piece.output.find("frame 32: the silhouette of camera \"cam02\" does not fit"), std::string::npos)
      << piece.output;
}

TEST(Reconstruct, AnEmptySilhouetteIsLeftOutWithAWarning) {
  const std::string capture = withoutMeshes("empty-matte"), out = scratch("empty-matte-out");
  fillMatte(capture, "01", "000001", 0);
  const Outcome made = fourdvt("reconstruct " + capture + " -o " + out + "/hull" + kCoarse);
  ASSERT_EQ(made.code, 0) << made.output;
  EXPECT_NE(made.output.find("\"cam01\": sees nothing of the performer in 1 of 3 frames (first 1)"), std::string::npos)
      << made.output;
  EXPECT_GT(fs::file_size(out + "/hull/turn/mesh/000001.ply"), 5000u);
}

TEST(Reconstruct, AMatteThatContradictsTheOthersIsNamed) {
  const std::string capture = withoutMeshes("odd-matte"), out = scratch("odd-matte-out");
  contradict(capture, "02", "000001");
  const Outcome made = fourdvt("reconstruct " + capture + " -o " + out + "/hull" + kCoarse);
  expectFailure(made, "\"cam02\" disagrees most", out + "/hull");
  EXPECT_NE(made.output.find("frame 1"), std::string::npos) << made.output;
}

TEST(Reconstruct, AFigurineAndAFewFacesNeedNoVoxelSize) {
  const std::string capture = withoutMeshes("figurine-capture"), out = scratch("figurine");
  const auto made = [&](const std::string& name, const std::string& more) {
    const Outcome outcome = fourdvt("reconstruct " + capture + " -o " + out + "/" + name + " --refine none" + more);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    return nlohmann::json::parse(readText(out + "/" + name + "/reconstruct.json"));
  };
  const auto large = made("large", "");
  const auto few = made("few", " --faces 1000");
  // The same pictures, with the scene scaled to a thousandth.
  ASSERT_EQ(shell("sed -i 's/\"metre\"/\"millimetre\"/' " + capture + "/capture.json").code, 0);
  const auto small = made("small", "");
  EXPECT_EQ(small["options"]["voxel_mm"], "auto");
  EXPECT_NEAR(small["mean_overlap"], large["mean_overlap"], 0.002);
  const auto frame = [](const nlohmann::json& report) { return report["sequences"].begin().value()[0]; };
  EXPECT_NEAR(frame(small)["voxel_m"].get<double>() * 1000, frame(large)["voxel_m"], 1e-6);
  EXPECT_NEAR(frame(small)["triangles"].get<double>(), frame(large)["triangles"],
              0.05 * frame(large)["triangles"].get<double>());
  EXPECT_LE(frame(few)["triangles"], 1000);
  EXPECT_GT(frame(few)["triangles_made"], 1000);
}

TEST(Reconstruct, OutputsThatWouldHarmAreRefused) {
  const std::string capture = withoutMeshes("kept-capture", 1), out = scratch("kept");
  EXPECT_EQ(fourdvt("reconstruct " + capture + " -o " + capture + "/hull" + kCoarse).code, 1);
  EXPECT_FALSE(exists(capture + "/hull"));
  EXPECT_EQ(fourdvt("reconstruct " + capture + " -o " + capture + kCoarse).code, 1);
  EXPECT_TRUE(exists(capture + "/capture.json"));
  writeText(out + "/notes.txt", "somebody's work");
  EXPECT_EQ(fourdvt("reconstruct " + capture + " -o " + out + kCoarse).code, 1);
  EXPECT_EQ(readText(out + "/notes.txt"), "somebody's work");
}

}  // namespace
}  // namespace fourdvt::test
