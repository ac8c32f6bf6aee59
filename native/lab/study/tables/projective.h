// SPDX-License-Identifier: Apache-2.0
// Report of `fourdvt-lab methods` from its rows alone (projective_rows.h): scores of the methods, verdicts on their
// papers' promises, and the recommended method.
#pragma once

#include "lab/study/tables/report.h"

namespace fourdvt::study {

Document makeProjectiveDocument(const Rows& rows, const StudyOptions& options, const std::string& capture_name);

// Recommended method for a surface ("given", "refined", "hull"), and the reasons against the others.
//
// Rule: excludes methods more than kPromise_db below linear blending, above kCostliest times FVVR's frame time, or
// above kFlickering times FVVR's flicker (if measured). Selects the best SSIM-FG of the rest; of those within
// kAlike_ssim of it, the cheapest.
inline constexpr double kPromise_db = 0.05, kPromise_ssim = 0.001, kCostliest = 2, kFlickering = 1.1,
                        kAlike_ssim = 0.002;
struct MethodPick {
  std::string method;                                        // empty: not measured
  std::vector<std::pair<std::string, std::string>> refused;  // method, reason
};
// Surfaces with a recommendation.
const std::vector<std::string>& judgedProxies();
MethodPick pickMethod(const StudyValues& values, const std::string& proxy);

// Verdicts on the papers' promises, over all rows.
std::vector<Judgement> judgeProjective(const StudyValues& values);

// Rows of the tables "choice" and "promise", for readers of the CSV.
Rows projectiveConclusions(const Rows& rows);

}  // namespace fourdvt::study
