// SPDX-License-Identifier: Apache-2.0
// Promises of Floating Textures (Eisemann et al. 2008) and Montage4D (Du et al. 2019) against the rows, and the
// recommended method.
#include <algorithm>
#include <cmath>

#include "lab/study/run/projective_rows.h"
#include "lab/study/tables/projective.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

double at(const StudyValues& v, const std::string& sequence, const std::string& method, const std::string& setting,
          const char* quantity) {
  return v.of(kCondition, sequence, method, setting, quantity);
}

// Sequence and setting of each row of a method's PSNR.
std::vector<std::pair<std::string, std::string>> conditionsOf(const StudyValues& v, const std::string& method) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Row& row : v.rows())
    if (row.table == kCondition && row.method == method && row.quantity == kPsnrFgDb)
      out.emplace_back(row.sequence, row.setting);
  return out;
}

std::string placeOf(const std::string& sequence, const std::string& setting) {
  return sequence + " " + settingText(setting, "axis") + " " + settingText(setting, "at");
}

std::string signedText(double value, int decimals) {
  std::string text = value > 0 ? "+" : "";
  return text += fixedText(value, decimals);
}

// Bounds the deficit of `method` against `other`, over all rows.
Judgement neverBelow(const StudyValues& v, const std::string& claim, const std::string& method,
                     const std::string& other, double slack_db, double slack_ssim) {
  double worst_db = std::nan(""), worst_ssim = std::nan("");
  size_t count = 0, above = 0;
  std::string below;
  for (const auto& [sequence, setting] : conditionsOf(v, method)) {
    const double db = at(v, sequence, method, setting, kPsnrFgDb) - at(v, sequence, other, setting, kPsnrFgDb);
    const double ssim = at(v, sequence, method, setting, kSsimFg) - at(v, sequence, other, setting, kSsimFg);
    if (std::isnan(db)) continue;
    ++count;
    worst_db = std::fmin(worst_db, db), worst_ssim = std::fmin(worst_ssim, ssim);
    above += db > 0 && ssim > 0;
    if (db < -slack_db || ssim < -slack_ssim)
      below += (below.empty() ? "" : "; ") + placeOf(sequence, setting) + ": " + signedText(db, 2) + " dB / " +
               signedText(ssim, 4);
  }
  return judged(claim, worst_db, below.empty(),
                std::to_string(count) + " rows, above in both on " + std::to_string(above) + "; least " +
                    signedText(worst_db, 2) + " dB / " + signedText(worst_ssim, 4),
                below);
}

Judgement montageAgainstHoloportation(const StudyValues& v, const char* own, const std::string& claim) {
  double decisive = std::nan("");
  size_t count = 0;
  double fewest = std::nan(""), most = std::nan("");
  std::string worse;
  for (const std::string& sequence : v.sequences(kCross))
    for (const std::string& proxy : v.settings(kCross, kMethodMontage, "proxy")) {
      const std::string filter = "proxy=" + proxy + " own=" + own;
      const auto both = [&](const char* quantity) {
        return std::pair{v.of(kCross, sequence, kMethodMontage, filter, quantity),
                         v.of(kCross, sequence, kMethodHoloportation, filter, quantity)};
      };
      const auto [rmse, rmse_other] = both(kRmse);
      const auto [db, db_other] = both(kPsnrFgDb);
      const auto [ssim, ssim_other] = both(kSsimFg);
      if (std::isnan(rmse) || std::isnan(rmse_other)) continue;
      ++count;
      const double less = 100 * (1 - rmse / rmse_other);
      decisive = less;
      fewest = std::fmin(fewest, less), most = std::fmax(most, less);
      if (rmse >= rmse_other || db <= db_other || ssim <= ssim_other)
        worse += (worse.empty() ? "" : "; ") + sequence + " " + proxy + ": RMSE " + signedText(-less, 1) + " %, " +
                 signedText(db - db_other, 2) + " dB, " + signedText(ssim - ssim_other, 4);
    }
  return judged(claim, decisive, worse.empty(),
                std::to_string(count) + " rows; RMSE lower by " + fixedText(fewest, 1) + " to " + fixedText(most, 1) +
                    " % (the paper: 40)",
                worse);
}

Judgement costAtMost(const StudyValues& v, const std::string& claim, const std::string& method,
                     const std::string& other, double limit) {
  const double ratio = v.mean(kCondition, method, "axis=proxy at=given", kFrameS) /
                       v.mean(kCondition, other, "axis=proxy at=given", kFrameS);
  return judged(claim, ratio, ratio <= limit, fixedText(ratio, 2) + " ×", "see the stages");
}

}  // namespace

std::vector<Judgement> judgeProjective(const StudyValues& v) {
  return {neverBelow(v, "Floating Textures are not worse than linear blending (FT 7), within .05 dB and .001 SSIM",
                     kMethodFloating, kMethodLinear, kPromise_db, kPromise_ssim),
          neverBelow(v, "The star form is within .1 dB of every picture to every other", kMethodFloating,
                     kMethodFloatingPairs, 0.1, 1),
          costAtMost(v, "The star form costs half of the pairs or less", kMethodFloating, kMethodFloatingPairs, 0.5),
          neverBelow(v, "The static mode is within .2 dB of the dynamic one, the star", kMethodFloatingStatic,
                     kMethodFloating, 0.2, 1),
          neverBelow(v, "The static mode is within .2 dB of the paper's dynamic one, every picture to every other",
                     kMethodFloatingStatic, kMethodFloatingPairs, 0.2, 1),
          neverBelow(v, "Every picture to every other is not worse than linear blending", kMethodFloatingPairs,
                     kMethodLinear, kPromise_db, kPromise_ssim),
          neverBelow(v, "The static mode is not worse than linear blending", kMethodFloatingStatic, kMethodLinear,
                     kPromise_db, kPromise_ssim),
          montageAgainstHoloportation(v, "0", "Montage4D is better than Holoportation at cameras that are left out"),
          montageAgainstHoloportation(v, "1", "The same with the camera's own picture among the drawn ones"),
          costAtMost(v, "A frame of Montage4D costs at most 2 × FVVR's", kMethodMontage, kFvvr, 2),
          costAtMost(v, "A frame of the sweep costs at most 2 × FVVR's", kMethodSweep, kFvvr, 2)};
}

const std::vector<std::string>& judgedProxies() {
  static const std::vector<std::string> proxies{kProxyGiven, kProxyRefined, kProxyHull};
  return proxies;
}

MethodPick pickMethod(const StudyValues& v, const std::string& proxy) {
  const std::string filter = "axis=proxy at=" + proxy;
  const auto value = [&](const std::string& method, const char* quantity) {
    return v.mean(kCondition, method, filter, quantity);
  };
  struct Candidate {
    std::string method;
    double ssim, cost;
  };
  std::vector<Candidate> left;
  MethodPick out;
  const double linear_db = value(kMethodLinear, kPsnrFgDb), flicker = value(kFvvr, kFlickerLevels);
  for (const std::string& method : v.methods(kCondition)) {
    const double ssim = value(method, kSsimFg), db = value(method, kPsnrFgDb), cost = value(method, kRatioToFvvr),
                 levels = value(method, kFlickerLevels);
    if (std::isnan(ssim)) continue;
    if (db < linear_db - kPromise_db)
      out.refused.emplace_back(method, fixedText(db - linear_db, 2) + " dB against linear");
    else if (cost > kCostliest)
      out.refused.emplace_back(method, "costs " + fixedText(cost, 1) + " × FVVR");
    else if (levels > kFlickering * flicker)
      out.refused.emplace_back(method, "flickers " + fixedText(levels / flicker, 2) + " × as much as FVVR");
    else
      left.push_back({method, ssim, cost});
  }
  if (left.empty()) return out;
  const double best =
      std::max_element(left.begin(), left.end(), [](const auto& a, const auto& b) { return a.ssim < b.ssim; })->ssim;
  const Candidate* pick = nullptr;
  for (const Candidate& candidate : left)
    if (candidate.ssim >= best - kAlike_ssim && (!pick || candidate.cost < pick->cost)) pick = &candidate;
  out.method = pick->method;
  return out;
}

Rows projectiveConclusions(const Rows& rows) {
  const StudyValues v(rows);
  Rows out;
  for (const std::string& proxy : judgedProxies()) {
    const std::string setting = "proxy=" + proxy;
    const MethodPick pick = pickMethod(v, proxy);
    if (pick.method.empty()) continue;
    out.push_back({kChoice, "", pick.method, setting, kTaken, 1, ""});
    for (const auto& [method, why] : pick.refused)
      out.push_back({kChoice, "", method, setting + " text=" + why, kRefused, 1, ""});
  }
  for (const Judgement& j : judgeProjective(v)) {
    const char* verdict = j.verdict == Judgement::Verdict::Holds   ? kHolds
                          : j.verdict == Judgement::Verdict::Fails ? kFails
                                                                   : kNotMeasured;
    std::string text = "text=" + j.claim;
    for (const auto& [before, part] : {std::pair<const char*, const std::string&>{": ", j.measured}, {"; ", j.reason}})
      if (!part.empty()) text += before + part;
    out.push_back({kPromise, "", "", text, verdict, 1, ""});
  }
  return out;
}

}  // namespace fourdvt::study
