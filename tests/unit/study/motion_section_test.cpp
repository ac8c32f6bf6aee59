// SPDX-License-Identifier: Apache-2.0
// The report's section on motion, from synthetic rows.
#include <gtest/gtest.h>

#include "lab/study/run/rows.h"
#include "lab/study/tables/report.h"

namespace fourdvt::study {
namespace {

Row row(const char* table, const std::string& method, const std::string& setting, const char* quantity, double value) {
  return {table, "locomotion", method, setting, quantity, value, ""};
}

Rows sampleRows() {
  Rows rows{row(rows::kMotionBlend, rows::kNonlinear, "", rows::kBlendMs, 10),
            row(rows::kMotionFlow, rows::kFlowGpu, "against=opencv size=512", rows::kDifferenceMeanPx, 0.111)};
  for (const auto& [references, error] : {std::pair{1, 4.5}, {2, 0.75}}) {
    const std::string setting = "references=" + std::to_string(references) + (references == 2 ? " baked=1" : "");
    rows.push_back(row(rows::kMotionBlend, rows::kHybrid, setting, rows::kErrorMaxMm, error));
    rows.push_back(row(rows::kMotionBlend, rows::kHybrid, setting, rows::kBlendMs, 0.1));
  }
  for (const auto& [method, ratio] : {std::pair{rows::kAlignNone, 0.80}, {rows::kAlignBaked, 0.93}})
    rows.push_back(row(rows::kMotionSharpness, method, "w=0.50", rows::kGradientRatio, ratio));
  for (const auto& [quantity, value] : {std::pair{rows::kLatencyMeanS, 0.2},
                                        {rows::kLatencyMaxS, 0.36},
                                        {rows::kLatencyPlayedMeanS, 0.3},
                                        {rows::kLatencyPlayedS, 0.4},
                                        {rows::kStepMm, 90.0},
                                        {rows::kOwnStepMm, 100.0},
                                        {rows::kChangeLevels, 12.0},
                                        {rows::kOwnChangeLevels, 10.0}})
    rows.push_back({rows::kMotionTransitions, "", "", "from=walk to=run", quantity, value, ""});
  return rows;
}

void addTruth(Rows& rows) {
  for (const auto& [method, psnr] :
       {std::pair{rows::kAlignNone, 25.0}, {rows::kAlignBaked, 31.25}, {rows::kFlowGpu, 30.5}})
    for (const char* w : {"0.20", "0.50"})
      rows.push_back(row(rows::kMotionAppearance, method, std::string("w=") + w + " mesh=truth region=common",
                         rows::kPsnrFgDb, psnr));
}

const Section* motionOf(const Document& document) {
  for (const Section& section : document.sections)
    if (section.id == "motion") return &section;
  return nullptr;
}

const std::vector<std::string>* rowOf(const Section& section, const std::string& first) {
  for (const Table& table : section.tables)
    for (const auto& row : table.rows)
      if (row[0].find(first) != std::string::npos) return &row;
  return nullptr;
}

std::string verdict(const Section& section, const std::string& goal) {
  const auto* row = rowOf(section, goal);
  return row ? (*row)[1] : "no such goal";
}

TEST(MotionSection, GoalsAreJudgedByTheRows) {
  Rows rows = sampleRows();
  addTruth(rows);
  const Document document = makeStudyDocument(rows, {}, "actor");
  const Section* section = motionOf(document);
  ASSERT_TRUE(section);
  EXPECT_EQ(verdict(*section, "Hybrid mesh blend, as baked"), "✓ holds");
  EXPECT_EQ(verdict(*section, "flow-gpu within"), "✓ holds");
  EXPECT_EQ(verdict(*section, "Half way as sharp"), "✗ does not hold");
  EXPECT_EQ(verdict(*section, "baked at least as good"), "✓ holds");
  EXPECT_EQ(verdict(*section, "Transitions are seen"), "✓ holds");
  EXPECT_EQ(verdict(*section, "No pop"), "✗ does not hold");
  EXPECT_EQ(verdict(*section, "1.3 × the plain blend"), "not measured");
  ASSERT_TRUE(rowOf(*section, "hybrid, R = 2 (as baked)"));
  EXPECT_EQ((*rowOf(*section, "hybrid, R = 2 (as baked)"))[1], "0.75");
  EXPECT_NE(report::documentHtml(document).find("4DVT Fig. 8"), std::string::npos);
}

TEST(MotionSection, WithoutTruthItsPartsAreLeftOut) {
  const Document document = makeStudyDocument(sampleRows(), {}, "actor");
  const Section* section = motionOf(document);
  ASSERT_TRUE(section);
  EXPECT_EQ(verdict(*section, "baked at least as good"), "not measured");
  for (const Table& table : section->tables) {
    EXPECT_EQ(table.title.find("Truth, drawn"), std::string::npos);
    EXPECT_EQ(table.title.find("known displacement"), std::string::npos);
  }
  for (const Plot& plot : section->plots) EXPECT_EQ(plot.title.find("truth"), std::string::npos);
}

TEST(MotionSection, NothingMeasuredIsNoSection) { EXPECT_FALSE(motionOf(makeStudyDocument({}, {}, "actor"))); }

}  // namespace
}  // namespace fourdvt::study
