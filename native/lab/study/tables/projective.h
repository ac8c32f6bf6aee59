// SPDX-License-Identifier: Apache-2.0
// The report of `fourdvt-lab methods` from its rows alone (projective_rows.h): what the methods score, what their
// papers promise, and which one to take. Does NOT measure.
#pragma once

#include "lab/study/tables/report.h"

namespace fourdvt::study {

Document makeProjectiveDocument(const Rows& rows, const StudyOptions& options, const std::string& capture_name);

// The method that a user should take on a surface ("given", "refined", "hull"), and what is said about the others.
//
// The rule: a method may not be below linear blending by more than kPromise_db, not cost more than kCostliest times
// FVVR's frame, and not flicker more than kFlickering times FVVR (where flicker was measured). Of those left, the one
// with the best SSIM-FG; of those within kAlike_ssim of it, the one that costs least.
inline constexpr double kPromise_db = 0.05, kPromise_ssim = 0.001, kCostliest = 2, kFlickering = 1.1,
                        kAlike_ssim = 0.002;
struct MethodPick {
  std::string method;                                        // empty: nothing was measured
  std::vector<std::pair<std::string, std::string>> refused;  // method, why
};
// The surfaces that a choice is made on.
const std::vector<std::string>& judgedProxies();
MethodPick pickMethod(const StudyValues& values, const std::string& proxy);

// What the papers promise, on every row.
std::vector<Judgement> judgeProjective(const StudyValues& values);

// Rows of the tables "choice" and "promise", for readers of the CSV.
Rows projectiveConclusions(const Rows& rows);

}  // namespace fourdvt::study
