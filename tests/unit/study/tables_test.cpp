// SPDX-License-Identifier: Apache-2.0
// The study's document, from synthetic rows.
#include <gtest/gtest.h>

#include <cmath>

#include "lab/study/run/rows.h"
#include "lab/study/tables/report.h"

namespace fourdvt::study {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void add(Rows& rows, const char* table, const std::string& sequence, const char* method, const std::string& setting,
         const char* quantity, double value) {
  rows.push_back({table, sequence, method, setting, quantity, value, ""});
}

const Section* find(const Document& document, const std::string& id) {
  for (const Section& section : document.sections)
    if (section.id == id) return &section;
  return nullptr;
}

const std::vector<std::string>* rowOf(const Table& table, const std::string& name) {
  for (const auto& row : table.rows)
    if (row[0] == name) return &row;
  return nullptr;
}

const std::string kSetting = "layers=3 size=512 codec=h264 crf=23";

TEST(StudyValues, FiltersAndMeans) {
  Rows rows;
  add(rows, rows::kLayers, "walk", rows::kJoint, "layers=3 size=512", rows::kSsimFg, 0.9);
  add(rows, rows::kLayers, "run", rows::kJoint, "size=512.0 layers=3", rows::kSsimFg, 0.8);
  add(rows, rows::kLayers, "walk", rows::kJoint, "layers=3 size=1024", rows::kSsimFg, 0.95);
  const StudyValues v(rows);
  EXPECT_DOUBLE_EQ(v.of(rows::kLayers, "walk", rows::kJoint, "size=512", rows::kSsimFg), 0.9);
  EXPECT_NEAR(v.mean(rows::kLayers, rows::kJoint, "layers=3 size=512", rows::kSsimFg), 0.85, 1e-12);
  EXPECT_NEAR(v.sum(rows::kLayers, rows::kJoint, "layers=3 size=512", rows::kSsimFg), 1.7, 1e-12);
  EXPECT_TRUE(std::isnan(v.mean(rows::kLayers, rows::kJoint, "layers=4", rows::kSsimFg)));
  EXPECT_EQ(v.numbers(rows::kLayers, "", "size"), (std::vector<double>{512, 1024}));
  EXPECT_TRUE(matchesFilter("preset=medium crf=23", "crf=23 !pass"));
  EXPECT_FALSE(matchesFilter("pass=shadow cast", "!pass"));
  EXPECT_EQ(rows::settingText("a=1 pass=shadow cast", "pass"), "shadow cast");
}

TEST(StudyDocument, Table1HoldsTheRows) {
  Rows rows;
  add(rows, rows::kTable1, "walk", rows::kFvvr, "", rows::kLoadingS, 12);
  add(rows, rows::kTable1, "walk", rows::kFvvr, "", rows::kTotalBytes, 40e6);
  add(rows, rows::kTable1, "walk", rows::kJoint, kSetting, rows::kTotalBytes, 1e6);
  add(rows, rows::kTable1, "walk", rows::kJoint, kSetting, rows::kSsimFg, 0.93456);
  add(rows, rows::kTable1, "walk", rows::kNaive, kSetting, rows::kTotalBytes, 1.5e6);
  add(rows, rows::kTable1, "run", rows::kNaive, kSetting, rows::kPsnrFgDb, 33.333);
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Section* section = find(document, "table1");
  ASSERT_NE(section, nullptr);
  ASSERT_EQ(section->tables.size(), 2u);
  const Table& walk = section->tables[0];
  EXPECT_EQ(walk.title, "walk");
  EXPECT_EQ(walk.columns, (std::vector<std::string>{"", "FVVR", "NO (naive)", "ours (joint)"}));
  const auto* storage = rowOf(walk, "Storage");
  ASSERT_NE(storage, nullptr);
  EXPECT_EQ(*storage, (std::vector<std::string>{"Storage", bytesText(40e6), bytesText(1.5e6), bytesText(1e6)}));
  EXPECT_EQ((*rowOf(walk, "Loading, to the first picture"))[1], secondsText(12));
  EXPECT_EQ((*rowOf(walk, "SSIM, foreground"))[3], "0.9346");
  EXPECT_EQ((*rowOf(walk, "SSIM, foreground"))[1], "–");
  EXPECT_EQ(rowOf(walk, "PSNR, foreground, dB"), nullptr);
  EXPECT_EQ((*rowOf(section->tables[1], "PSNR, foreground, dB"))[2], "33.33");
}

Judgement judgement(const std::vector<Judgement>& all, const std::string& start) {
  for (const Judgement& j : all)
    if (j.claim.rfind(start, 0) == 0) return j;
  ADD_FAILURE() << "no claim starts with " << start;
  return {};
}

TEST(StudyDocument, GoalsAndTrendsAreJudgedByTheRows) {
  Rows rows;
  const char* methods[] = {rows::kNaive, rows::kSpatial, rows::kTemporalPaper, rows::kJoint};
  const double bytes[] = {1.5e6, 1.3e6, 1.31e6, 1.0e6}, flips[] = {10, 8, 7.9, 3.5};
  for (size_t i = 0; i < 4; ++i) {
    add(rows, rows::kTable1, "walk", methods[i], kSetting, rows::kTotalBytes, bytes[i]);
    add(rows, rows::kTable1, "walk", methods[i], kSetting, rows::kVideoBytes, bytes[i] * 0.7);
    add(rows, rows::kTable1, "walk", methods[i], kSetting, rows::kLabelBytes, bytes[i] * 0.1);
    add(rows, rows::kLabels, "walk", methods[i], "layer=1", rows::kFlipPercent, flips[i]);
  }
  add(rows, rows::kTable1, "walk", rows::kFvvr, "", rows::kTotalBytes, 40e6);
  add(rows, rows::kHeldOut, "walk", rows::kFvvr, "views=12", rows::kPsnrFgDb, 31.0);
  add(rows, rows::kHeldOut, "walk", rows::kJoint, "views=12", rows::kPsnrFgDb, 30.8);
  for (int layers = 1; layers <= 6; ++layers)
    add(rows, rows::kLayers, "walk", rows::kJoint, "layers=" + std::to_string(layers) + " size=512", rows::kSsimFg,
        layers < 3 ? 0.85 + 0.03 * layers : 0.94 + 0.0002 * layers);
  const StudyValues v(rows);
  const auto goals = judgeGoals(v), trends = judgeTrends(v);
  EXPECT_EQ(judgement(goals, "Storage at L = 3").verdict, Judgement::Verdict::Holds);  // 97.5 %
  EXPECT_EQ(judgement(goals, "Labels: joint has at least 50 %").verdict, Judgement::Verdict::Holds);
  const Judgement held_out = judgement(goals, "Held-out truth, ours (joint)");
  EXPECT_EQ(held_out.verdict, Judgement::Verdict::Fails);
  EXPECT_EQ(held_out.measured, "−0.20 dB against FVVR");
  EXPECT_FALSE(held_out.reason.empty());
  EXPECT_EQ(judgement(goals, "Layered rendering").verdict, Judgement::Verdict::NotMeasured);
  EXPECT_EQ(judgement(trends, "SSIM rises to L = 3").verdict, Judgement::Verdict::Holds);
  EXPECT_EQ(judgement(trends, "Storage NO (naive) > SO").verdict, Judgement::Verdict::Holds);
  const Judgement to = judgement(trends, "Storage SO (spatial) > TO");
  EXPECT_EQ(to.verdict, Judgement::Verdict::Fails);
  EXPECT_TRUE(contains(to.reason, "Eq. 5 as printed")) << to.reason;
  EXPECT_EQ(judgement(trends, "GPU memory").verdict, Judgement::Verdict::NotMeasured);
}

TEST(StudyDocument, RateCurvesAreInterpolatedAtTheDefaultsQuality) {
  Rows rows;
  for (const auto& [crf, bps, ssim] : {std::tuple{18, 8e6, 0.96}, {28, 2e6, 0.92}}) {
    const std::string setting = "preset=medium crf=" + std::to_string(crf) + " size=1024";
    add(rows, rows::kRate, "walk", "h264", setting, rows::kVideoBps, bps);
    add(rows, rows::kRate, "walk", "h264", setting, rows::kSsimFg, ssim);
  }
  add(rows, rows::kRate, "walk", "h264", "chosen=1 preset=medium crf=23 size=1024", rows::kSsimFg, 0.94);
  add(rows, rows::kRate, "walk", "h264", "chosen=1 preset=medium crf=23 size=1024", rows::kVideoBps, 4e6);
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Section* section = find(document, "rate");
  ASSERT_NE(section, nullptr);
  ASSERT_EQ(section->plots.size(), 1u);
  ASSERT_EQ(section->plots[0].curves.size(), 1u);
  EXPECT_EQ(section->plots[0].curves[0].points, (std::vector<std::pair<double, double>>{{2, 0.92}, {8, 0.96}}));
  EXPECT_EQ(section->tables[0].rows[0][1], bitrateText(4e6));  // geometric mean of 2 and 8
}

const Table* tableThat(const Section& section, const std::string& start) {
  for (const Table& table : section.tables)
    if (table.title.rfind(start, 0) == 0) return &table;
  return nullptr;
}

TEST(StudyDocument, StorageAtEqualQualityIsNeverExtrapolated) {
  Rows rows;
  add(rows, rows::kTable1, "walk", rows::kJoint, kSetting, rows::kTotalBytes, 1e6);
  add(rows, rows::kTable1, "walk", rows::kJoint, kSetting, rows::kPercentAtPsnr, 25);
  add(rows, rows::kTable1, "walk", rows::kJoint, kSetting, rows::kBeyondAtSsim, 1);
  add(rows, rows::kTable1, "walk", rows::kNaive, kSetting, rows::kBeyondAtPsnr, -1);
  for (const auto& [crf, psnr] : {std::pair{"crf=18", 23.5}, {"crf=42", 21.25}})
    add(rows, rows::kMultiviewCodec, "walk", "h264", crf, rows::kHeldOutPsnrDb, psnr);
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Table* table = tableThat(*find(document, "storage"), "Storage at equal quality");
  ASSERT_NE(table, nullptr);
  EXPECT_TRUE(contains(table->note, "21.25 to 23.50 dB")) << table->note;
  EXPECT_EQ((*rowOf(*table, "ours (joint)"))[3], percentText(25));
  EXPECT_EQ((*rowOf(*table, "ours (joint)"))[5], "beyond the range measured: better than FVVR at every rate measured");
  EXPECT_EQ((*rowOf(*table, "NO (naive)"))[3], "beyond the range measured: worse than FVVR at every rate measured");
}

TEST(StudyDocument, LayersAreComparedAtEqualBitrate) {
  Rows rows;
  const auto point = [&](int layers, int crf, double bps, double psnr) {
    const std::string setting =
        "preset=medium crf=" + std::to_string(crf) + " size=1024 layers=" + std::to_string(layers) + " layout=default";
    add(rows, rows::kRate, "walk", "h264", setting, rows::kVideoBps, bps);
    add(rows, rows::kRate, "walk", "h264", setting, rows::kPsnrFgDb, psnr);
  };
  point(1, 20, 4e6, 21.0), point(1, 30, 1e6, 20.0);
  point(3, 20, 8e6, 23.0), point(3, 30, 2e6, 22.0);
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Table* table = tableThat(*find(document, "rate"), "What view dependence is worth");
  ASSERT_NE(table, nullptr);
  EXPECT_EQ(table->columns, (std::vector<std::string>{"bitrate", "PSNR-FG, dB, L = 1", "PSNR-FG, dB, L = 3",
                                                      "SSIM-FG, L = 1", "SSIM-FG, L = 3"}));
  EXPECT_EQ(table->rows[0][1], "20.50");  // 2 Mbit/s lies half way between 1 and 4
  EXPECT_EQ(table->rows[0][2], "22.00");
  EXPECT_EQ(table->rows[1][1], "–");  // one layer was not measured at 8 Mbit/s
}

TEST(StudyDocument, SpeedIsGivenForAllCamerasAndForTheClosest) {
  Rows rows;
  for (const auto& [closest, ratio] : {std::pair{"", 4.0}, {" closest=3", 1.5}}) {
    const std::string setting = std::string("layers=3 size=512 view=512x512") + closest;
    add(rows, rows::kSpeed, "walk", rows::kFvvr, setting, rows::kFramesPerS, 30 / ratio);
    add(rows, rows::kSpeed, "walk", rows::kFvvr, setting + " pass=512x512 upload", rows::kFrameMs, 10 * ratio);
    add(rows, rows::kSpeed, "walk", rows::kMethodLayered, setting, rows::kRatioToFvvr, ratio);
    add(rows, rows::kSpeed, "walk", rows::kMethodLayered, setting, rows::kDrawRatioToFvvr, ratio / 2);
  }
  add(rows, rows::kSpeed, "walk", rows::kMethodLayered, "layers=3 size=512 view=512x512", rows::kFramesPerS, 30);
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Table& rates = find(document, "speed")->tables[0];
  EXPECT_EQ((*rowOf(rates, "FVVR, all cameras"))[3], "4.00 ×");
  EXPECT_EQ((*rowOf(rates, "FVVR, M = 3"))[3], "1.50 ×");
  EXPECT_EQ((*rowOf(rates, "FVVR, M = 3"))[4], "0.75 ×");
  const Table* passes = tableThat(*find(document, "speed"), "Passes");
  ASSERT_NE(passes, nullptr);
  EXPECT_EQ(*rowOf(*passes, "512x512 upload"), (std::vector<std::string>{"512x512 upload", "–", "40.000", "15.000"}));
}

TEST(StudyDocument, LabelGainsAreJudgedOnSeenFacesToo) {
  Rows rows;
  const auto label = [&](const char* method, double all, double seen) {
    add(rows, rows::kLabels, "walk", method, "layer=1", rows::kSeamPercent, all);
    add(rows, rows::kLabels, "walk", method, "layer=1", rows::kSeenSeamPercent, seen);
  };
  label(rows::kSpatial, 10, 10), label(rows::kJoint, 6, 9);
  const auto goals = judgeGoals(StudyValues(rows));
  const std::string claim = "Labels: joint has at least 30 % fewer seam edges in layer 1 than spatial";
  EXPECT_EQ(judgement(goals, claim).verdict, Judgement::Verdict::Holds);
  const Judgement seen = judgement(goals, claim + ", counted on faces");
  EXPECT_EQ(seen.verdict, Judgement::Verdict::Fails);
  EXPECT_TRUE(contains(seen.measured, percentText(10))) << seen.measured;
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Table* table = tableThat(*find(document, "labels"), "Over faces that a camera sees");
  ASSERT_NE(table, nullptr);
  EXPECT_EQ((*rowOf(*table, "ours (joint)"))[1], "9.00");
}

TEST(StudyDocument, NothingMeasuredIsADocumentThatSaysSo) {
  StudyOptions options;
  options.quick = true;
  const Document document = makeStudyDocument({}, options, "actor");
  EXPECT_EQ(find(document, "table1"), nullptr);
  ASSERT_NE(find(document, "settings"), nullptr);
  EXPECT_TRUE(contains(find(document, "settings")->text, "4DVT Table 1"));
  const std::string html = report::documentHtml(document);
  EXPECT_FALSE(contains(html, "nan"));
  EXPECT_TRUE(contains(html, "not measured"));
}

TEST(StudyDocument, PicturesCarryFileAndCaption) {
  Rows rows;
  add(rows, rows::kPictures, "walk", rows::kJoint, "file=layers.jpg layers=4 frame=9 width=1600 height=900",
      rows::kPictureLayers, 0);
  const Document document = makeStudyDocument(rows, {}, "actor");
  ASSERT_NE(find(document, "camera-maps"), nullptr);
  const Picture& picture = find(document, "camera-maps")->pictures.at(0);
  EXPECT_EQ(picture.file, "pictures/layers.jpg");
  EXPECT_EQ(picture.width, 1600);
  EXPECT_EQ(picture.caption, "Layers and their camera maps, walk, ours (joint), L = 4, frame 9");
}

}  // namespace
}  // namespace fourdvt::study
