// SPDX-License-Identifier: Apache-2.0
// The study's machinery on synthetic rows, steps and rigs: CSV, matched quality, resume, ring of views, scores.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "lab/study/run/ring.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/run_steps.h"
#include "measure/metrics.h"
#include "measure/picture_score.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

namespace fs = std::filesystem;

Row row(const std::string& table, const std::string& method, const std::string& setting, const std::string& quantity,
        double value) {
  return {table, "run", method, setting, quantity, value, "bytes"};
}

TEST(StudyCsv, RowsSurviveCommasQuotesAndLineBreaks) {
  const Rows rows{{"a,b", "say \"run\"", "", "text=one, \"two\"\nthree", "q", -1.25e-7, "dB"},
                  {"t", "", "m", "", "inf", HUGE_VAL, ""},
                  {"t", "s", "m", "x=1 y=2", "large", 1234567890, "bytes"}};
  auto back = parseRowsCsv(rowsCsv(rows), "f.csv");
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back.value().size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(back.value()[i].table, rows[i].table);
    EXPECT_EQ(back.value()[i].sequence, rows[i].sequence);
    EXPECT_EQ(back.value()[i].method, rows[i].method);
    EXPECT_EQ(back.value()[i].setting, rows[i].setting);
    EXPECT_EQ(back.value()[i].quantity, rows[i].quantity);
    EXPECT_EQ(back.value()[i].value, rows[i].value);
    EXPECT_EQ(back.value()[i].unit, rows[i].unit);
  }
}

TEST(StudyCsv, DamageNamesFileAndLine) {
  const std::string good = rowsCsv({row("t", "m", "", "q", 1), row("t", "m", "", "q", 2)});
  for (const std::string& bad : {std::string("x,y\n"), good + "t,s,m,,q,notanumber,\n", good + "t,s,m\n",
                                 good.substr(0, good.size() - 3) + "\"open", std::string()}) {
    auto read = parseRowsCsv(bad, "folder/f.csv");
    ASSERT_FALSE(read) << bad;
    EXPECT_EQ(read.error().id, ErrorId::FileUnreadable);
    EXPECT_NE(read.error().message.find("folder/f.csv"), std::string::npos);
  }
  EXPECT_NE(parseRowsCsv(good + "t,s,m\n", "f").error().message.find("line 4"), std::string::npos);
}

TEST(StudyJson, HoldsTheRowsAndWhatWasRun) {
  StudyOptions options;
  options.generator = "fourdvt 1.2.3";
  options.sequences = {"walk", "run"};
  options.quick = true;
  const Rows rows{row("t", "m \"x\"", "a=1", "q", 0.125), row("t", "m", "", "none", NAN)};
  const std::string path = (fs::temp_directory_path() / ("fourdvt_json_" + std::to_string(getpid()))).string();
  ASSERT_TRUE(platform::writeFileAtomic(path, rowsJson(rows, options, "actor")));
  const auto json = platform::readJsonFlat(path);
  fs::remove(path);
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ(json.value().string("/generator"), "fourdvt 1.2.3");
  EXPECT_EQ(json.value().string("/capture"), "actor");
  EXPECT_EQ(json.value().string("/sequences/1"), "run");
  EXPECT_EQ(json.value().string("/rows/0/method"), "m \"x\"");
  EXPECT_EQ(json.value().string("/rows/0/setting"), "a=1");
  EXPECT_EQ(json.value().number("/rows/0/value"), 0.125);
  EXPECT_EQ(json.value().string("/rows/1/quantity"), "none");
  EXPECT_FALSE(json.value().number("/rows/1/value"));
  EXPECT_FALSE(json.value().has("/rows/2"));
}

TEST(StudyQuality, BytesAreLogLinearBetweenKnownPointsAndUnknownBeyondThem) {
  const std::vector<RatePoint> points{{1000, 40}, {100, 30}, {10000, 44}};  // any order
  const auto bytesAt = [&](double quality) { return bytesAtQuality(points, quality).bytes; };
  EXPECT_NEAR(*bytesAt(30), 100, 1e-9);
  EXPECT_NEAR(*bytesAt(35), std::sqrt(100 * 1000.0), 1e-6);
  EXPECT_NEAR(*bytesAt(42), std::sqrt(1000 * 10000.0), 1e-6);
  EXPECT_NEAR(*bytesAt(44), 10000, 1e-6);
  EXPECT_FALSE(bytesAt(29.9));
  EXPECT_EQ(bytesAtQuality(points, 29.9).beyond, -1);
  EXPECT_FALSE(bytesAt(44.1));
  EXPECT_EQ(bytesAtQuality(points, 44.1).beyond, 1);
  EXPECT_EQ(bytesAtQuality(points, 35).beyond, 0);
  EXPECT_EQ(*bytesAtQuality({{100, 30}}, 30).bytes, 100);
  EXPECT_FALSE(bytesAtQuality({}, 30).bytes);
  EXPECT_FALSE(bytesAt(NAN));
}

// --- steps ---

std::map<std::string, int> g_runs;
bool g_fail_second = false;

Result<Rows> firstStep(const StudyContext& context) {
  ++g_runs["first"];
  if (context.progress) context.progress({"first", "half", 0.5});
  return Rows{row("t", "first", "", "q", 1)};
}
Result<Rows> secondStep(const StudyContext& context) {
  ++g_runs["second"];
  FOURDVT_TRY(checkStop(context));
  if (g_fail_second) return Error{ErrorId::Internal, "broken"};
  Rows out;
  const auto measure = []() -> Result<Rows> {
    ++g_runs["part"];
    return Rows{row("t", "second", "", "q", 2)};
  };
  FOURDVT_TRY(addPart(context, "part", measure, out));
  return out;
}
const StudyStep kSteps[] = {{"one", 1, firstStep}, {"two", 3, secondStep}};

class StudySteps : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = (fs::temp_directory_path() / ("fourdvt_study_" + std::string(info->name()) + std::to_string(getpid())))
                  .string();
    fs::remove_all(folder_);
    context_.options.capture_folder = "capture";
    context_.options.report_folder = folder_;
    g_runs.clear();
    g_fail_second = false;
  }
  void TearDown() override { fs::remove_all(folder_); }
  Result<Rows> run(const std::string& key) {
    FOURDVT_ASSIGN(const auto steps, askedSteps(kSteps, context_.options.steps));
    FOURDVT_TRY(openReportFolder(folder_, key));
    return runSteps(context_, steps, [&](const Rows& rows) -> Status {
      published_.push_back(rows.size());
      return {};
    });
  }
  std::string folder_;
  StudyContext context_;
  std::vector<size_t> published_;
};

TEST_F(StudySteps, FinishedStepsAreKept) {
  auto first = run("key");
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first.value().size(), 2u);
  EXPECT_EQ(published_, (std::vector<size_t>{1, 2}));  // after every step
  auto again = run("key");
  ASSERT_TRUE(again);
  EXPECT_EQ(rowsCsv(again.value()), rowsCsv(first.value()));
  EXPECT_EQ(g_runs, (std::map<std::string, int>{{"first", 1}, {"second", 1}, {"part", 1}}));
}

TEST_F(StudySteps, OnlyTheStepsAskedForRunAndTheirRowsStay) {
  context_.options.steps = {"two"};
  auto second = run("key");
  ASSERT_TRUE(second);
  EXPECT_EQ(g_runs, (std::map<std::string, int>{{"second", 1}, {"part", 1}}));
  ASSERT_EQ(second.value().size(), 1u);
  EXPECT_EQ(second.value()[0].method, "second");
  context_.options.steps = {"two", "one"};
  auto both = run("key");
  ASSERT_TRUE(both);
  ASSERT_EQ(both.value().size(), 2u);
  EXPECT_EQ(both.value()[0].method, "first") << "in the study's order";
  EXPECT_EQ(g_runs, (std::map<std::string, int>{{"first", 1}, {"second", 1}, {"part", 1}}));
  context_.options.steps = {"three"};
  auto unknown = run("key");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().id, ErrorId::InvalidArgument);
  EXPECT_NE(unknown.error().message.find("\"three\"; the steps are one, two"), std::string::npos);
}

TEST_F(StudySteps, AnotherKeyRunsEverythingAgain) {
  ASSERT_TRUE(run("key"));
  ASSERT_TRUE(run("other key"));
  EXPECT_EQ(g_runs["first"], 2);
  EXPECT_EQ(g_runs["part"], 2);
}

TEST_F(StudySteps, AReportOfAnotherKeyIsNotOverwritten) {
  ASSERT_TRUE(run("key"));
  ASSERT_TRUE(platform::writeFileAtomic(folder_ + "/evaluate.csv", "rows").ok());
  const Status opened = openReportFolder(folder_, "other key");
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().id, ErrorId::InvalidArgument);
  EXPECT_NE(opened.error().message.find(folder_), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ + "/evaluate.csv"));
  EXPECT_TRUE(openReportFolder(folder_, "key").ok());
}

TEST_F(StudySteps, AFailedStepIsRunAgainButNotTheOnesBefore) {
  g_fail_second = true;
  auto failed = run("key");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "broken");
  g_fail_second = false;
  ASSERT_TRUE(run("key"));
  EXPECT_EQ(g_runs, (std::map<std::string, int>{{"first", 1}, {"second", 2}, {"part", 1}}));
}

TEST_F(StudySteps, DamagedRowsAreMeasuredAgain) {
  ASSERT_TRUE(run("key"));
  std::ofstream(folder_ + "/steps/one.csv") << "table,seq";
  ASSERT_TRUE(run("key"));
  EXPECT_EQ(g_runs["first"], 2);
  EXPECT_EQ(g_runs["second"], 1);
}

TEST_F(StudySteps, StoppingSaysHowToGoOn) {
  std::atomic<bool> stop{true};
  context_.stop = &stop;
  context_.options.sequences = {"walk", "run"};
  auto stopped = run("key");
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().id, ErrorId::Interrupted);
  EXPECT_NE(stopped.error().message.find("fourdvt-lab study 'capture' -o '" + folder_ + "' --sequences walk,run"),
            std::string::npos);
  EXPECT_TRUE(g_runs.empty());
  stop = false;
  EXPECT_TRUE(run("key"));
}

TEST_F(StudySteps, ProgressIsOfTheWholeStudy) {
  std::vector<double> shares;
  context_.progress = [&](const StudyProgress& p) { shares.push_back(p.share); };
  ASSERT_TRUE(run("key"));
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_NE(std::find(shares.begin(), shares.end(), 0.125), shares.end());  // half of a quarter
  EXPECT_DOUBLE_EQ(shares.back(), 1);
}

TEST_F(StudySteps, AForeignFolderIsLeftAlone) {
  fs::create_directories(folder_);
  std::ofstream(folder_ + "/thesis.txt") << "mine";
  const Status opened = openReportFolder(folder_, "key");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().id, ErrorId::InvalidArgument);
  EXPECT_TRUE(fs::exists(folder_ + "/thesis.txt"));
  EXPECT_FALSE(fs::exists(folder_ + "/steps"));
}

TEST_F(StudySteps, KeyFollowsSettingsAndFiles) {
  fs::create_directories(folder_ + "/capture/report");
  std::ofstream(folder_ + "/capture/a.txt") << "1";
  StudyOptions options{folder_ + "/capture", folder_ + "/capture/report", {"run"}, false, 0};
  const std::string key = studyKey(options, "v");
  std::ofstream(folder_ + "/capture/report/evaluate.csv") << "2";  // the report itself is not an input
  EXPECT_EQ(studyKey(options, "v"), key);
  EXPECT_NE(studyKey(options, "w"), key);
  options.quick = true;
  EXPECT_NE(studyKey(options, "v"), key);
  options.quick = false;
  options.sequences.push_back("walk");
  EXPECT_NE(studyKey(options, "v"), key);
  options.sequences.pop_back();
  std::ofstream(folder_ + "/capture/a.txt") << "12";
  EXPECT_NE(studyKey(options, "v"), key);
}

// --- views ---

TEST(StudyRing, AzimuthsHoldCamerasAndMiddles) {
  std::vector<double> cameras;
  for (int c = 0; c < 8; ++c) cameras.push_back(45.0 * c);
  const auto ring = ringAzimuths_deg(cameras, 36);
  ASSERT_EQ(ring.size(), 36u);
  for (double special = 0; special < 360; special += 22.5)
    EXPECT_NE(std::find(ring.begin(), ring.end(), special), ring.end()) << special;
  for (size_t i = 1; i < ring.size(); ++i) {
    EXPECT_GE(ring[i] - ring[i - 1], 5);
    EXPECT_LE(ring[i] - ring[i - 1], 15);
  }
  const auto few = ringAzimuths_deg(cameras, 8);
  ASSERT_EQ(few.size(), 8u);
  int middles = 0;
  for (double a : few) middles += std::fmod(a, 45) != 0;
  EXPECT_EQ(middles, 4);
  EXPECT_EQ(std::set<double>(few.begin(), few.end()).size(), 8u);
}

TEST(StudyRing, ViewsSeeAllOfTheBoxAsDenselyAsTheCameras) {
  const BoundingBox bounds{{-0.4f, 0, -0.3f}, {0.4f, 1.7f, 0.5f}};
  const glm::dvec3 target(0, 0.85, 0.1);
  std::vector<PinholeCamera> cameras;
  for (int c = 0; c < 4; ++c) {
    PinholeCamera camera = cameraFromOrbit({90.0 * c, c % 2 ? 20.0 : 10.0, 4 + 0.2 * c, target, 30}, 720, 960);
    cameras.push_back(camera);
  }
  const auto views = ringViews(cameras, bounds, 19, 36);
  ASSERT_EQ(views.size(), 36u);
  EXPECT_EQ(views[0].frame, 0u);
  EXPECT_EQ(views[35].frame, 18u);
  for (const RingView& view : views) {
    EXPECT_LE(view.camera.width, 720);
    EXPECT_LE(view.camera.height, 960);
    EXPECT_NEAR(view.camera.fx, cameras[0].fx, 1e-6);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                         corner & 4 ? bounds.max.z : bounds.min.z);
      const glm::dvec3 pixel = view.camera.project(p);
      EXPECT_GE(pixel.x, 0);
      EXPECT_LE(pixel.x, view.camera.width);
      EXPECT_GE(pixel.y, 0);
      EXPECT_LE(pixel.y, view.camera.height);
    }
  }
  for (const PinholeCamera& camera : cameras) {
    double nearest = 1e9;
    for (const RingView& view : views)
      nearest = std::min(nearest, glm::length(view.camera.centreInWorld() - camera.centreInWorld()));
    EXPECT_LT(nearest, 1e-6);
  }
}

Image squareOn(int width, int height, int x0, int y0, int side, uint8_t grey) {
  Image out(width, height, 4);
  for (int y = y0; y < y0 + side; ++y)
    for (int x = x0; x < x0 + side; ++x) {
      uint8_t* p = out.at(x, y);
      p[0] = p[1] = p[2] = static_cast<uint8_t>(grey + (x * 7 + y * 13) % 32);
      p[3] = 255;
    }
  return out;
}

TEST(StudyScore, RegionsHaveTheirKnownPsnr) {
  const Image a = squareOn(80, 60, 20, 10, 30, 100), b = squareOn(80, 60, 20, 10, 30, 110);
  const measure::PictureScore same = measure::scorePicture(a, a), other = measure::scorePicture(a, b);
  EXPECT_EQ(same.psnr_fg_db, 100);
  EXPECT_NEAR(same.ssim_full, 1, 1e-12);
  const double expected = 20 * std::log10(255 / 10.0);
  EXPECT_NEAR(other.psnr_fg_db, expected, 1e-9);
  EXPECT_NEAR(other.psnr_box_db, expected, 1e-9);
  EXPECT_NEAR(other.psnr_common_db, expected, 1e-9);
  EXPECT_NEAR(other.psnr_full_db, expected + 10 * std::log10(80 * 60 / 900.0), 1e-9);
}

// The score computes a crop only; it must equal the whole picture's.
TEST(StudyScore, SsimEqualsThatOfTheWholePicture) {
  for (const auto& [x, y] : {std::pair{20, 10}, {0, 0}, {50, 30}, {3, 28}}) {
    const Image a = squareOn(80, 60, x, y, 30, 100), b = squareOn(80, 60, x, y, 29, 140);
    const measure::PictureScore score = measure::scorePicture(a, b);
    const Image ca = measure::compositedOnBlack(a), cb = measure::compositedOnBlack(b);
    EXPECT_NEAR(score.ssim_full, measure::ssim(ca, cb, measure::Mask(80 * 60, 1)), 1e-9);
    EXPECT_NEAR(score.ssim_fg, measure::ssim(ca, cb, measure::unionOfSilhouettes(a, b)), 1e-9);
    EXPECT_LT(score.ssim_fg, score.ssim_full);
  }
}

TEST(StudyScore, PixelsSeenAreARegionOfTheirOwn) {
  const Image a = squareOn(80, 60, 20, 10, 30, 100);
  Image b = a;
  measure::Mask seen(80 * 60);
  for (int y = 10; y < 40; ++y)
    for (int x = 20; x < 50; ++x) {
      const bool in_left_half = x < 35;
      seen[size_t(y) * 80 + x] = in_left_half;
      for (int c = 0; c < 3; ++c) b.at(x, y)[c] = static_cast<uint8_t>(b.at(x, y)[c] + (in_left_half ? 10 : 20));
    }
  const measure::PictureScore score = measure::scoreWithSeen(a, b, seen);
  EXPECT_NEAR(score.psnr_seen_db, 20 * std::log10(255 / 10.0), 1e-9);
  EXPECT_NEAR(score.ssim_seen, measure::ssim(measure::compositedOnBlack(a), measure::compositedOnBlack(b), seen), 1e-9);
  EXPECT_EQ(score.psnr_fg_db, measure::scorePicture(a, b).psnr_fg_db);
  measure::MeanScores without, with;
  without.add(measure::scorePicture(a, b));
  with.add(score);
  Rows out;
  writeScores({out, "t", "s", "without", ""}, without);
  writeScores({out, "t", "s", "with", ""}, with);
  const auto seenRows = [&](const std::string& method) {
    return std::count_if(out.begin(), out.end(), [&](const Row& r) {
      return r.method == method && (r.quantity == "psnr_seen_db" || r.quantity == "ssim_seen");
    });
  };
  EXPECT_EQ(seenRows("without"), 0);
  EXPECT_EQ(seenRows("with"), 2);
}

TEST(StudyScore, MeansHaveAStandardError) {
  measure::MeanScores scores;
  const auto add = [&](double psnr_db) {
    measure::PictureScore score;
    score.psnr_fg_db = psnr_db;
    scores.add(score);
  };
  add(20);
  EXPECT_TRUE(std::isnan(scores.standardError().psnr_fg_db));
  for (const double psnr_db : {23.0, 26.0}) add(psnr_db);
  EXPECT_DOUBLE_EQ(scores.mean().psnr_fg_db, 23);
  EXPECT_NEAR(scores.standardError().psnr_fg_db, std::sqrt(3.0), 1e-9);
  Rows out;
  writeScores({out, "t", "s", "m", ""}, scores);
  const auto error = std::find_if(out.begin(), out.end(), [](const Row& r) { return r.quantity == "psnr_fg_se_db"; });
  ASSERT_NE(error, out.end());
  EXPECT_NEAR(error->value, std::sqrt(3.0), 1e-9);
}

TEST(StudyScore, LaneKeepsTheOrder) {
  const Image a = squareOn(80, 60, 20, 10, 30, 100);
  measure::ScoreLane lane;
  for (int i = 0; i < 9; ++i)
    lane.add(a, squareOn(80, 60, 20, 10, 30, static_cast<uint8_t>(101 + i)), std::to_string(i));
  const auto scores = lane.finish();
  ASSERT_EQ(scores.size(), 9u);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(scores[i].first, std::to_string(i));
    EXPECT_NEAR(scores[i].second.psnr_fg_db, 20 * std::log10(255.0 / (i + 1)), 1e-9);
  }
}

}  // namespace
}  // namespace fourdvt::study
