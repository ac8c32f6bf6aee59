// SPDX-License-Identifier: Apache-2.0
// Bakes in pieces, each in its own process: the same bytes as in one process, even after failures of pieces.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "command.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kSmall = " --texture 128 --layers 2 --gop 4 --renditions highest";

struct Job {
  std::string capture, out, options;
  std::string character() const { return out + "/box"; }
  std::string folder() const { return out + "/box.work"; }
  Outcome plan() const { return fourdvt("plan bake " + capture + " -o " + character() + options); }
  Outcome bake(const std::string& more = "") const {
    return fourdvt("bake " + capture + " -o " + character() + options + more);
  }
  Outcome piece(const std::string& id) const { return fourdvt("piece " + folder() + " " + id); }
  json pieces() const { return json::parse(readText(folder() + "/plan.json"))["pieces"]; }
  std::vector<std::string> ids() const {
    std::vector<std::string> out;
    for (const json& piece : pieces()) out.push_back(piece["id"]);
    return out;
  }
  std::string done(const std::string& id) const {
    for (const json& piece : pieces())
      if (piece["id"] == id) return folder() + "/" + std::string(piece["done"]);
    return {};
  }
  void runAll() const {
    for (const std::string& id : ids()) {
      const Outcome outcome = piece(id);
      ASSERT_EQ(outcome.code, 0) << id << ": " << outcome.output;
    }
  }
};

Job planned(const std::string& name, int frames = 6, const std::string& options = "") {
  Job job{smallCapture(name + "-capture", frames), scratch(name), kSmall + options};
  const Outcome plan = job.plan();
  EXPECT_EQ(plan.code, 0) << plan.output;
  EXPECT_NE(plan.output.find("snakemake --directory " + job.folder()), std::string::npos) << plan.output;
  return job;
}

// Runs every piece whose inputs are finished, choosing the last possible one first.
void runBackwards(const Job& job) {
  std::set<std::string> done;
  const json pieces = job.pieces();
  while (done.size() < pieces.size()) {
    const auto ready = [&](const json& piece) {
      return !done.count(piece["id"]) && std::all_of(piece["needs"].begin(), piece["needs"].end(),
                                                     [&](const json& need) { return done.count(need) > 0; });
    };
    const auto next = std::find_if(pieces.rbegin(), pieces.rend(), ready);
    ASSERT_NE(next, pieces.rend()) << "a circle";
    const Outcome outcome = job.piece((*next)["id"]);
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    done.insert((*next)["id"]);
  }
}

TEST(Job, LayersInPiecesAreTheSameBytes) {
  const Job job = planned("job-layers", 40);  // two windows of the survey, windows of labels on either side of another
  ASSERT_EQ(job.bake().code, 0);
  const std::string whole = copyOf(job.character(), "job-layers-whole");
  const std::string outline = job.character() + ".report/report_outline_cam00.jpg", of_whole = readText(outline);
  ASSERT_TRUE(fs::remove(outline));
  ASSERT_EQ(job.plan().code, 0);
  const auto ids = job.ids();
  for (const char* id :
       {"survey-turn-1", "colours", "labels-turn-even-0", "labels-turn-odd-0", "label-turn", "gop-turn-9", "finish"})
    EXPECT_EQ(std::count(ids.begin(), ids.end(), id), 1) << id;
  runBackwards(job);
  EXPECT_EQ(differences(whole, job.character()), std::vector<std::string>());
  EXPECT_EQ(readText(outline), of_whole);
  for (const auto& entry : fs::directory_iterator(job.folder())) {
    const std::string name = entry.path().filename().string();
    EXPECT_FALSE(name.starts_with("result.") || name.starts_with("report.")) << name << " is left";
  }
  const json report = json::parse(readText(job.folder() + "/job.json"));
  EXPECT_EQ(report["lost_starts"], 0);
  EXPECT_EQ(report["over_memory"], json::array());
  EXPECT_EQ(report["kinds"]["gop"]["done"], 10);
  const Outcome status = fourdvt("job " + job.folder());
  EXPECT_NE(status.output.find(std::to_string(ids.size()) + " of " + std::to_string(ids.size()) + " pieces"),
            std::string::npos)
      << status.output;
}

TEST(Job, CamerasInPiecesAreTheSameBytes) {
  const Job job = planned("job-cameras", 6, " --appearance cameras");
  ASSERT_EQ(job.bake().code, 0);
  const std::string whole = copyOf(job.character(), "job-cameras-whole");
  ASSERT_EQ(job.plan().code, 0);
  runBackwards(job);
  EXPECT_EQ(differences(whole, job.character()), std::vector<std::string>());
  EXPECT_EQ(json::parse(readText(job.folder() + "/job.json"))["over_memory"], json::array());
}

TEST(Job, KilledPieceIsDoneAgainAndNoPieceTwice) {
  const Job job = planned("job-killed");
  ASSERT_EQ(job.piece("survey-turn-0").code, 0);
  const std::string attempts = job.folder() + "/attempts";
  // Kills the piece as soon as its start is recorded.
  shell(std::string(FOURDVT_BIN) + " piece " + job.folder() + " colours & piece=$!; while ! ls " + attempts +
        " | grep -q colours; do :; done; kill -9 $piece; wait $piece");
  EXPECT_FALSE(exists(job.done("colours")));
  const Outcome early = job.piece("gop-turn-0");
  EXPECT_EQ(early.code, 1);
  EXPECT_TRUE(isOneLineWith(early, "piece gop-turn-0 needs colours, label-turn, which are not done")) << early.output;
  const Outcome status = fourdvt("job " + job.folder());
  EXPECT_NE(status.output.find("1 start without a result"), std::string::npos) << status.output;
  const auto before = fs::last_write_time(job.done("survey-turn-0"));
  job.runAll();
  EXPECT_EQ(fs::last_write_time(job.done("survey-turn-0")), before) << "it was done";
  EXPECT_EQ(json::parse(readText(job.folder() + "/job.json"))["lost_starts"], 1);
  const std::string pieces = copyOf(job.character(), "job-killed-pieces");
  ASSERT_EQ(job.bake().code, 0);
  EXPECT_EQ(differences(pieces, job.character()), std::vector<std::string>());
}

TEST(Job, SamePieceTwiceAtOnceIsHarmless) {
  const Job job = planned("job-twice");
  for (const std::string& id : job.ids()) {
    const std::string command = std::string(FOURDVT_BIN) + " piece " + job.folder() + " " + id;
    const Outcome both = shell(command + " & first=$!; " + command + "; second=$?; wait $first && exit $second");
    ASSERT_EQ(both.code, 0) << id << ": " << both.output;
  }
  const std::string pieces = copyOf(job.character(), "job-twice-pieces");
  ASSERT_EQ(job.bake().code, 0);
  EXPECT_EQ(differences(pieces, job.character()), std::vector<std::string>());
}

TEST(Job, FullDiskOfOneMachineLeavesThePieceToOthers) {
  const Job job = planned("job-full");
  const Outcome full =
      shell("trap '' XFSZ; ulimit -f 1; " + std::string(FOURDVT_BIN) + " piece " + job.folder() + " survey-turn-0");
  EXPECT_EQ(full.code, 1) << full.output;
  EXPECT_NE(full.output.find("free"), std::string::npos) << full.output;
  EXPECT_FALSE(exists(job.done("survey-turn-0")));
  job.runAll();
  EXPECT_EQ(json::parse(readText(job.folder() + "/job.json"))["lost_starts"], 1);
}

TEST(Job, OutputsOfAnotherBuildAreRefused) {
  const Job job = planned("job-build");
  json plan = json::parse(readText(job.folder() + "/plan.json"));
  const std::string build = plan["tool"]["build"];
  plan["tool"]["build"] = "0123456789abcdef";
  writeText(job.folder() + "/plan.json", plan.dump());
  const Outcome refused = job.piece("survey-turn-0");
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(isOneLineWith(refused, "made by fourdvt")) << refused.output;
  EXPECT_NE(refused.output.find(build), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("0123456789abcdef"), std::string::npos) << refused.output;
  EXPECT_FALSE(exists(job.done("survey-turn-0")));
}

TEST(Job, FilesThatChangedAreNamedByThePieceThatReadsThem) {
  const Job job = planned("job-changed", 40);
  writeText(job.capture + "/turn/cam00/000035.png", "another picture");
  const Outcome refused = job.piece("survey-turn-1");
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(isOneLineWith(refused, job.capture + "/turn: files of frames 32 to 39 have changed since the plan was"))
      << refused.output;
  EXPECT_EQ(job.piece("survey-turn-0").code, 0) << "it does not read them";
  writeText(job.capture + "/capture.json", readText(job.capture + "/capture.json") + " ");
  const Outcome common = job.piece("gop-turn-0");
  EXPECT_EQ(common.code, 1);
  const Outcome described = job.piece("labels-turn-even-0");
  EXPECT_TRUE(described.output.find("capture.json, cameras or plates have changed") != std::string::npos ||
              described.output.find("needs survey-turn-1") != std::string::npos)
      << described.output;
}

TEST(Job, TriedMethodsDependOnTheFirstFrame) {
  const Job job = planned("job-method", 40, " --appearance cameras --no-colour-calibration");
  writeText(job.capture + "/turn/cam00/000000.png", "another picture");
  EXPECT_TRUE(isOneLineWith(job.piece("method-2"), "/turn: files of frames 0 to 31 have changed since the plan was"));
}

TEST(Job, MeshesAreCheckedByThePiecesThatReadAllOfThem) {
  const Job job = planned("job-meshes");
  ASSERT_EQ(job.piece("survey-turn-0").code, 0);
  std::string mesh;
  for (const auto& file : fs::recursive_directory_iterator(job.capture + "/turn"))
    if (file.path().extension() == ".obj" || file.path().extension() == ".ply") mesh = file.path().string();
  ASSERT_FALSE(mesh.empty());
  fs::last_write_time(mesh, fs::last_write_time(mesh) + std::chrono::seconds(5));
  EXPECT_TRUE(isOneLineWith(job.piece("label-turn"), job.capture + "/turn: its meshes have changed since the plan"));
}

// Prevents mixing results of two builds: a key of the plan contains the build.
TEST(Job, FolderOfAnotherBuildBeginsAgain) {
  const Job job = planned("job-other-build");
  ASSERT_EQ(job.piece("survey-turn-0").code, 0);
  const std::string settings = job.folder() + "/settings.txt", text = readText(settings);
  const size_t build = text.find("build ");
  ASSERT_NE(build, std::string::npos) << text;
  writeText(settings, text.substr(0, build) + "build 0123456789abcdef\n");
  EXPECT_TRUE(isOneLineWith(job.piece("colours"), "is not the folder of this plan any more"));
  const Outcome again = job.plan();
  ASSERT_EQ(again.code, 0) << again.output;
  EXPECT_NE(again.output.find("all begins again"), std::string::npos) << again.output;
  EXPECT_FALSE(exists(job.done("survey-turn-0")));
}

// Simulates Slurm's answers by a fake scontrol.
TEST(Job, SlurmJobsThatWillNeverStartFail) {
  const Job job = planned("job-slurm");
  const std::string bin = job.out + "/bin";
  fs::create_directory(bin);
  writeText(bin + "/scancel", "#!/bin/sh\n");
  fs::permissions(bin + "/scancel", fs::perms::owner_all);
  fs::create_directories(job.folder() + "/logs");
  const auto statusOf = [&](const std::string& state, const std::string& reason) {
    writeText(bin + "/scontrol",
              "#!/bin/sh\necho JobId=7 JobName=a JobState=" + state + " Reason=" + reason + " A=b\n");
    fs::permissions(bin + "/scontrol", fs::perms::owner_all);
    return shell("cd " + job.folder() + " && PATH=" + bin + ":$PATH sh profiles/slurm/status.sh 7").output;
  };
  EXPECT_EQ(statusOf("PENDING", "Resources"), "running\n");
  EXPECT_EQ(statusOf("PENDING", "PartitionNodeLimit"), "running\n");  // also while nodes are drained
  for (const char* reason : {"PartitionTimeLimit", "QOSMaxWallDurationPerJobLimit", "BadConstraints"}) {
    EXPECT_EQ(statusOf("PENDING", reason), "failed\n");
    const std::string log = readText(job.folder() + "/logs/slurm-7.log");
    EXPECT_NE(log.find(std::string("will not start job 7: ") + reason), std::string::npos) << log;
  }
  EXPECT_EQ(statusOf("RUNNING", "None"), "running\n");
  EXPECT_EQ(statusOf("COMPLETED", "None"), "success\n");
  EXPECT_EQ(statusOf("NODE_FAIL", "None"), "failed\n");
}

TEST(Job, PlanOfAChangedCaptureBeginsAgainAndSaysSo) {
  const Job job = planned("job-again");
  ASSERT_EQ(job.piece("survey-turn-0").code, 0);
  const Outcome same = job.plan();
  EXPECT_EQ(same.code, 0);
  EXPECT_EQ(same.output.find("begins again"), std::string::npos) << same.output;
  EXPECT_TRUE(exists(job.done("survey-turn-0"))) << "a plan of the same keeps what is done";
  fs::last_write_time(job.capture + "/turn/cam00/000002.png", fs::file_time_type::clock::now());
  const Outcome other = job.plan();
  EXPECT_EQ(other.code, 0);
  EXPECT_NE(
      other.output.find(job.folder() + ": holds work of other settings, of another capture or of another version"),
      std::string::npos)
      << other.output;
  EXPECT_FALSE(exists(job.done("survey-turn-0")));
}

TEST(Job, ClocksOfMachinesMayDiffer) {
  const Job job = planned("job-clocks");
  const auto ids = job.ids();
  int step = 0;
  for (const std::string& id : ids) {
    ASSERT_EQ(job.piece(id).code, 0) << id;
    for (const auto& file : fs::recursive_directory_iterator(job.folder()))
      if (file.is_regular_file())
        fs::last_write_time(file.path(),
                            fs::file_time_type::clock::now() + std::chrono::hours(++step % 2 ? 900 : -900));
  }
  EXPECT_EQ(json::parse(readText(job.folder() + "/job.json"))["lost_starts"], 0);
  const Outcome again = job.piece(ids.front());
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.output, "") << "nothing to do";
}

TEST(Job, BakeGoesOnWithWhatPiecesHaveDone) {
  const Job job = planned("job-resumed");
  const auto ids = job.ids();
  for (size_t i = 0; i + 2 < ids.size(); ++i) ASSERT_EQ(job.piece(ids[i]).code, 0) << ids[i];
  const Outcome bake = job.bake(" --resume");
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_EQ(json::parse(readText(job.character() + ".report/report.json"))["resumed"], true);
  EXPECT_FALSE(exists(job.folder()));
  const std::string resumed = copyOf(job.character(), "job-resumed-pieces");
  ASSERT_EQ(job.bake().code, 0);
  EXPECT_EQ(differences(resumed, job.character()), std::vector<std::string>());
}

TEST(Job, WrongCommandsAreNamed) {
  const std::string out = scratch("job-wrong");
  for (const auto& [arguments, code, part] : {std::tuple("plan", 2, "plan needs a command line"),
                                              {"plan bake", 2, "CAPTURE"},
                                              {"piece ", 2, "JOB"},
                                              {"job no-such-folder", 1, "no-such-folder/plan.json: there is none"}}) {
    const Outcome outcome = fourdvt(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << outcome.output;
    EXPECT_NE(outcome.output.find(part), std::string::npos) << arguments << outcome.output;
  }
  const Job job = planned("job-names");
  EXPECT_TRUE(isOneLineWith(job.piece("gop-turn-99"), "has no piece \"gop-turn-99\""));
  for (const char* file : {"/Snakefile", "/profiles/local/config.yaml", "/profiles/slurm/config.yaml"})
    EXPECT_TRUE(exists(job.folder() + file)) << file;
}

}  // namespace
}  // namespace fourdvt::test
