// SPDX-License-Identifier: Apache-2.0
// Plans and records of jobs: inputs of a piece's name, and conditions under which a piece counts as finished.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "jobs/records.h"
#include "platform/files.h"
#include "platform/process.h"

namespace fourdvt::jobs {
namespace {

namespace fs = std::filesystem;

Plan smallPlan() {
  Plan plan;
  plan.tool = thisTool();
  plan.command = "bake";
  plan.arguments = {"capture \"A\"", "-o", "b"};
  plan.capture = "/c", plan.result = "/b";
  plan.frames = 40, plan.capture_s = 1.6;
  plan.pieces = {{"survey-a-0", "survey", {}, 10, 500, 7},
                 {"survey-a-1", "survey", {}, 10, 500, 8},
                 {"gop-a-0", "gop", {"survey-a-0"}, 20, 800, 7},
                 {"finish", kFinish, {"survey-a-0", "survey-a-1", "gop-a-0"}, 5, 300, 0}};
  EXPECT_TRUE(settleHashes("a", plan).ok());
  return plan;
}

std::string textOf(const fs::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Jobs : testing::Test {
  void SetUp() override {
    fs::remove_all(folder);
    ASSERT_TRUE(writePlan(folder.string(), plan).ok());
  }
  ~Jobs() override { fs::remove_all(folder); }
  void finish(const std::string& id) {
    auto attempt = Attempt::begin(folder.string(), *plan.find(id));
    ASSERT_TRUE(attempt.ok());
    EXPECT_TRUE(attempt.value().finish().ok());
  }
  const fs::path folder = fs::path(testing::TempDir()) / ("fourdvt_jobs_" + std::to_string(::getpid()));
  const Plan plan = smallPlan();
};

TEST_F(Jobs, PlanReadsBack) {
  const auto read = readPlan(folder.string());
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(planJson(read.value()), planJson(plan));
  const auto json = nlohmann::json::parse(textOf(folder / "plan.json"));
  EXPECT_EQ(json["format"], 1);
  EXPECT_EQ(json["arguments"][0], "capture \"A\"");
  EXPECT_EQ(json["pieces"][2]["done"], plan.pieces[2].done()) << "which Snakemake waits for";
  EXPECT_EQ(json["pieces"][2]["needs"], nlohmann::json({"survey-a-0"}));
}

TEST_F(Jobs, DamagedAndForeignPlansAreNamed) {
  for (const char* text : {"", "{", "[]", "{\"format\": 2}", "{\"format\": 1}"}) {
    std::ofstream(folder / "plan.json") << text;
    const auto read = readPlan(folder.string());
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_EQ(read.error().id, ErrorId::FileUnreadable);
    EXPECT_NE(read.error().message.find("plan.json"), std::string::npos);
    EXPECT_NE(read.error().message.find("fourdvt plan"), std::string::npos);
  }
  fs::remove(folder / "plan.json");
  EXPECT_EQ(readPlan(folder.string()).error().id, ErrorId::FileMissing);
}

// A hash covers the inputs of the piece and of all its prerequisites, and no others.
TEST(JobPlan, NamesOfOutputsFollowWhatTheyDependOn) {
  const Plan plan = smallPlan();
  Plan other = plan;
  other.pieces[0].inputs = 99;
  ASSERT_TRUE(settleHashes("a", other).ok());
  EXPECT_NE(other.pieces[0].done(), plan.pieces[0].done());
  EXPECT_EQ(other.pieces[1].done(), plan.pieces[1].done());
  EXPECT_NE(other.pieces[2].done(), plan.pieces[2].done());
  EXPECT_NE(other.pieces[3].done(), plan.pieces[3].done());
  ASSERT_TRUE(settleHashes("b", other).ok());
  EXPECT_NE(other.pieces[1].done(), plan.pieces[1].done()) << "other settings";
  std::swap(other.pieces[0], other.pieces[2]);
  EXPECT_EQ(settleHashes("a", other).error().id, ErrorId::Internal) << "a piece before one that it needs";
}

TEST_F(Jobs, PlanOfAnotherBuildIsRefused) {
  EXPECT_TRUE(checkTool("j", plan).ok());
  Plan other = plan;
  other.tool = {"0.1", "0123456789abcdef", "/opt/fourdvt"};
  const Status refused = checkTool("j", other);
  ASSERT_FALSE(refused.ok());
  for (const std::string& part : {std::string("j/plan.json"), std::string("0123456789abcdef"),
                                  std::string("/opt/fourdvt"), thisTool().build, platform::hostName()})
    EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
}

TEST_F(Jobs, OneRecordCountsHoweverOftenAPieceIsStarted) {
  const Piece& piece = plan.pieces[0];
  EXPECT_FALSE(isDone(folder.string(), piece));
  auto killed = Attempt::begin(folder.string(), piece);
  auto first = Attempt::begin(folder.string(), piece), second = Attempt::begin(folder.string(), piece);
  ASSERT_TRUE(killed.ok() && first.ok() && second.ok());
  EXPECT_FALSE(isDone(folder.string(), piece)) << "started, not done";
  const auto record = first.value().finish();
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record.value().attempt, 2u);
  EXPECT_EQ(record.value().host, platform::hostName());
  EXPECT_GT(record.value().peak_mb, 1);
  const std::string text = textOf(folder / piece.done());
  EXPECT_EQ(second.value().finish().value().attempt, 2u) << "of two at once the first counts";
  EXPECT_EQ(textOf(folder / piece.done()), text);
  const Progress progress = readProgress(folder.string(), plan);
  EXPECT_EQ(progress.done.size(), 1u);
  EXPECT_EQ(progress.attempts.at(piece.id), 3u);
}

TEST_F(Jobs, ClocksDoNotDecideWhatIsDone) {
  finish("survey-a-0");
  for (const int years : {-40, 40}) {
    fs::last_write_time(folder / plan.pieces[0].done(),
                        fs::file_time_type::clock::now() + std::chrono::hours(24 * 365 * years));
    EXPECT_TRUE(isDone(folder.string(), plan.pieces[0]));
    EXPECT_TRUE(checkNeeds(folder.string(), plan, plan.pieces[2]).ok());
  }
}

TEST_F(Jobs, ADamagedRecordIsNone) {
  finish("survey-a-0");
  std::ofstream(folder / plan.pieces[0].done()) << "{\"id\": \"survey";
  EXPECT_FALSE(isDone(folder.string(), plan.pieces[0]));
  finish("survey-a-0");
  EXPECT_TRUE(isDone(folder.string(), plan.pieces[0]));
}

TEST_F(Jobs, MissingNeedsAreNamed) {
  finish("survey-a-1");
  const Status missing = checkNeeds(folder.string(), plan, plan.pieces[3]);
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.error().message.find("finish needs survey-a-0, gop-a-0,"), std::string::npos)
      << missing.error().message;
}

TEST_F(Jobs, ReportShowsCostAndLostStarts) {
  EXPECT_NE(progressLine(plan, readProgress(folder.string(), plan)).find("0 of 4 pieces, about 45"), std::string::npos);
  ASSERT_TRUE(Attempt::begin(folder.string(), plan.pieces[0]).ok());
  finish("survey-a-0");
  const Progress progress = readProgress(folder.string(), plan);
  EXPECT_NE(progressLine(plan, progress).find("1 of 4 pieces, 1 start without a result"), std::string::npos)
      << progressLine(plan, progress);
  ASSERT_TRUE(writeReport(folder.string(), plan, progress).ok());
  const auto json = nlohmann::json::parse(textOf(folder / kReportJson));
  EXPECT_EQ(json["kinds"]["survey"]["pieces"], 2);
  EXPECT_EQ(json["kinds"]["survey"]["done"], 1);
  EXPECT_EQ(json["kinds"]["survey"]["starts"], 2);
  EXPECT_EQ(json["lost_starts"], 1);
  const std::string html = textOf(folder / kReportHtml);
  EXPECT_NE(html.find("survey-a-0"), std::string::npos);
  EXPECT_NE(html.find("per minute of capture"), std::string::npos);
}

TEST_F(Jobs, AFolderThatIsFullIsAWriteError) {
  fs::remove_all(folder / "attempts");
  EXPECT_EQ(Attempt::begin(folder.string(), plan.pieces[0]).error().id, ErrorId::WriteFailed);
}

}  // namespace
}  // namespace fourdvt::jobs
