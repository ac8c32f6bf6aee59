// SPDX-License-Identifier: Apache-2.0
// The report on methods from cameras, from synthetic rows: the recommended method, and verdicts.
#include "lab/study/tables/projective.h"

#include <gtest/gtest.h>

#include "lab/study/run/projective_rows.h"

namespace fourdvt::study {
namespace {

struct MethodRow {
  const char* method;
  double db, ssim, flicker, frame_ms;
};

void add(Rows& rows, const std::string& axis, const std::string& at, const MethodRow& r) {
  const std::string setting = "axis=" + axis + " at=" + at + " proxy=given closest=4 views=3";
  const auto row = [&](const char* quantity, double value) {
    rows.push_back({rows::kCondition, "run", r.method, setting, quantity, value, ""});
  };
  row(rows::kPsnrFgDb, r.db), row(rows::kSsimFg, r.ssim);
  if (r.flicker >= 0) row(rows::kFlickerLevels, r.flicker);
  row(rows::kFrameS, 1e-3 * r.frame_ms), row(rows::kRatioToFvvr, r.frame_ms / 10);
}

Rows onHull(std::initializer_list<MethodRow> methods) {
  Rows out;
  for (const MethodRow& m : methods) add(out, "proxy", "hull", m);
  return out;
}

std::string picked(const Rows& rows) { return pickMethod(StudyValues(rows), "hull").method; }

std::string refusal(const Rows& rows, const std::string& method) {
  for (const auto& [name, why] : pickMethod(StudyValues(rows), "hull").refused)
    if (name == method) return why;
  return "";
}

TEST(MethodPick, IsTheBestThatFollowsTheRules) {
  const Rows rows = onHull({{"linear", 20, 0.70, 4, 12},
                            {"fvvr", 20, 0.69, 4, 10},
                            {"blurry", 19.9, 0.80, 2, 10},      // below linear
                            {"slow", 21, 0.79, 4, 25},          // 2.5 × FVVR
                            {"flickering", 21, 0.78, 4.5, 10},  // 1.125 × FVVR
                            {"good", 19.96, 0.75, 4.3, 19}});
  EXPECT_EQ(picked(rows), "good");
  EXPECT_EQ(refusal(rows, "blurry"), "−0.10 dB against linear");
  EXPECT_EQ(refusal(rows, "slow"), "costs 2.5 × FVVR");
  EXPECT_EQ(refusal(rows, "flickering"), "flickers 1.12 × as much as FVVR");
  EXPECT_EQ(refusal(rows, "good"), "");
}

TEST(MethodPick, OfThoseThatAreAlikeTheCheapestIsTaken) {
  EXPECT_EQ(picked(onHull({{"linear", 20, 0.7000, 4, 12}, {"fvvr", 20, 0.6985, 4, 10}})), "fvvr");
  EXPECT_EQ(picked(onHull({{"linear", 20, 0.7000, 4, 12}, {"fvvr", 20, 0.6975, 4, 10}})), "linear");
}

TEST(MethodPick, WithoutFlickerOrRowsNothingIsRefusedForIt) {
  EXPECT_EQ(picked(onHull({{"fvvr", 20, 0.69, -1, 10}, {"good", 20, 0.75, -1, 15}})), "good");
  EXPECT_EQ(pickMethod(StudyValues(Rows()), "hull").method, "");
}

const Judgement& judgement(const std::vector<Judgement>& all, const std::string& claim) {
  for (const Judgement& j : all)
    if (j.claim.find(claim) != std::string::npos) return j;
  static const Judgement none{"no such claim", "", Judgement::Verdict::NotMeasured, ""};
  ADD_FAILURE() << claim;
  return none;
}

TEST(ProjectiveGoals, OneRowBelowIsEnoughAndIsNamed) {
  Rows rows;
  add(rows, "proxy", "given", {"linear", 20, 0.700, 4, 12});
  add(rows, "proxy", "given", {"floating", 19.96, 0.7100, 4, 20});
  add(rows, "rotation", "0.1", {"linear", 18, 0.500, 4, 12});
  add(rows, "rotation", "0.1", {"floating", 18.2, 0.560, 4, 20});
  using Verdict = Judgement::Verdict;
  {
    const auto all = judgeProjective(StudyValues(rows));
    EXPECT_EQ(judgement(all, "not worse than linear").verdict, Verdict::Holds);
    EXPECT_NE(judgement(all, "not worse than linear").measured.find("2 rows, above in both on 1; least −0.04 dB"),
              std::string::npos)
        << judgement(all, "not worse than linear").measured;
    EXPECT_EQ(judgement(all, "star form costs").verdict, Verdict::NotMeasured);
  }
  add(rows, "gain", "6", {"linear", 18, 0.5000, 4, 12});
  add(rows, "gain", "6", {"floating", 18, 0.4985, 4, 12});
  add(rows, "proxy", "given", {"floating-pairs", 20, 0.71, 4, 39});
  const auto all = judgeProjective(StudyValues(rows));
  EXPECT_EQ(judgement(all, "not worse than linear").verdict, Verdict::Fails);
  EXPECT_EQ(judgement(all, "not worse than linear").reason, "run gain 6: 0.00 dB / −0.0015");
  EXPECT_EQ(judgement(all, "star form costs").verdict, Verdict::Fails);  // 20 of 39 ms
  EXPECT_EQ(judgement(all, "star form is within").verdict, Verdict::Holds);
}

TEST(ProjectiveGoals, ThePairsAndTheStillModeHaveGoalsOfTheirOwn) {
  Rows rows;
  add(rows, "proxy", "given", {"linear", 20, 0.700, 4, 12});
  add(rows, "proxy", "given", {"floating", 20.5, 0.720, 4, 20});
  add(rows, "proxy", "given", {"floating-pairs", 20.3, 0.698, 4, 40});
  add(rows, "proxy", "given", {"floating-static", 20.2, 0.6995, 4, 12});
  const auto all = judgeProjective(StudyValues(rows));
  using Verdict = Judgement::Verdict;
  EXPECT_EQ(judgement(all, "dynamic one, the star").verdict, Verdict::Fails);  // −.3 dB
  EXPECT_EQ(judgement(all, "the paper's dynamic one").verdict, Verdict::Holds);
  EXPECT_EQ(judgement(all, "other is not worse than linear").verdict, Verdict::Fails);  // −.002 SSIM
  EXPECT_EQ(judgement(all, "static mode is not worse than linear").verdict, Verdict::Holds);
}

void addCross(Rows& rows, const char* method, const char* own, double rmse, double db, double ssim) {
  const std::string setting = std::string("proxy=given own=") + own;
  rows.push_back({rows::kCross, "run", method, setting, rows::kRmse, rmse, ""});
  rows.push_back({rows::kCross, "run", method, setting, rows::kPsnrFgDb, db, ""});
  rows.push_back({rows::kCross, "run", method, setting, rows::kSsimFg, ssim, ""});
}

TEST(ProjectiveGoals, MontageMustWinInAllThreeMeasures) {
  Rows rows;
  addCross(rows, "holoportation", "0", 0.10, 20, 0.70);
  addCross(rows, "montage4d", "0", 0.08, 21.9, 0.69);  // lower SSIM
  addCross(rows, "holoportation", "1", 0.10, 20, 0.70);
  addCross(rows, "montage4d", "1", 0.06, 24.4, 0.80);
  const auto all = judgeProjective(StudyValues(rows));
  EXPECT_EQ(judgement(all, "at cameras that are left out").verdict, Judgement::Verdict::Fails);
  EXPECT_EQ(judgement(all, "own picture").verdict, Judgement::Verdict::Holds);
  EXPECT_NE(judgement(all, "own picture").measured.find("40.0 to 40.0 %"), std::string::npos);
}

TEST(ProjectiveConclusions, AreRowsOfTheirOwn) {
  const Rows rows = onHull({{"linear", 20, 0.70, 4, 12}, {"fvvr", 20, 0.69, 4, 10}, {"slow", 21, 0.79, 4, 25}});
  const Rows conclusions = projectiveConclusions(rows);
  const auto has = [&](const std::string& table, const std::string& method, const std::string& setting,
                       const std::string& quantity) {
    for (const Row& row : conclusions)
      if (row.table == table && row.method == method && row.setting == setting && row.quantity == quantity) return true;
    return false;
  };
  EXPECT_TRUE(has(rows::kChoice, "linear", "proxy=hull", rows::kTaken));
  EXPECT_TRUE(has(rows::kChoice, "slow", "proxy=hull text=costs 2.5 × FVVR", rows::kRefused));
  EXPECT_TRUE(has(rows::kPromise, "", "text=A frame of the sweep costs at most 2 × FVVR's", rows::kNotMeasured));
}

TEST(ProjectiveDocument, HoldsTheRows) {
  Rows rows;
  for (const char* at : {"given", "hull"}) {
    add(rows, "proxy", at, {"fvvr", 22.25, 0.7777, 3.3, 10});
    add(rows, "proxy", at, {"linear", 22.5, 0.8, 3, 12});
  }
  add(rows, "cameras", "2", {"fvvr", 21, 0.75, 3, 10});
  add(rows, "rotation", "0.05", {"fvvr", 19.25, 0.55, 3, 10});
  addCross(rows, "fvvr", "0", 0.077, 22.2, 0.7);
  rows.push_back({rows::kStage, "run", "fvvr", "proxy=given pass=depth maps", rows::kFrameMs, 1.25, "ms"});
  rows.push_back(
      {rows::kPictures, "run", "", "file=methods-run.jpg view=test00 frame=8", rows::kPictureMethods, 1, ""});
  rows.push_back({rows::kAbout, "", "", "text=sweep: no such method", "method left out", 0, ""});
  const Document document = makeProjectiveDocument(rows, {}, "actor");
  const std::string html = report::documentHtml(document);
  for (const char* part : {"22.25 / 0.7777", "rotation 0.05°", "19.25 / 0.5500", "depth maps", "1.25", "7.70 %",
                           "methods-run.jpg", "sweep: no such method", "✓ take this", "FT Fig. 8"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  const auto section = [&](const std::string& id) -> const Section* {
    for (const Section& s : document.sections)
      if (s.id == id) return &s;
    return nullptr;
  };
  ASSERT_TRUE(section("cameras"));
  ASSERT_EQ(section("cameras")->plots.size(), 2u);  // SSIM and PSNR
  // Points from the condition, and from the base at four cameras.
  const std::vector<std::pair<double, double>> points{{2, 0.75}, {4, 0.7777}};
  ASSERT_EQ(section("cameras")->plots[0].curves.size(), 1u);
  EXPECT_EQ(section("cameras")->plots[0].curves[0].points, points);
  EXPECT_FALSE(section("worst"));
  EXPECT_EQ(makeProjectiveDocument({}, {}, "actor").sections.size(), 2u);  // promises, all unmeasured; settings
}

}  // namespace
}  // namespace fourdvt::study
