// SPDX-License-Identifier: Apache-2.0
#include "bake/method/method_choice.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/text.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kLinear = "linear";
constexpr double kSmallGap_deg = 30;

double squaredError(double psnr_db) { return std::pow(10, -psnr_db / 10); }

// Estimates PSNR of a visitor's view from the scores with and without the view's own camera.
double visitorsDb(const MethodScore& score, double own_share) {
  if (own_share <= 0) return score.psnr_db;
  return -10 * std::log10((1 - own_share) * squaredError(score.psnr_db) + own_share * squaredError(score.own_psnr_db));
}

}  // namespace

std::string ChoiceRule::check() const {
  if (!(most_cost >= 1 && most_cost <= 100)) return "method cost must be 1..100 frames of fvvr";
  if (!(below_linear_db >= 0 && tie_db >= 0 && tie_ssim >= 0)) return "margins of the method must not be negative";
  if (!(own_share >= 0 && own_share < 1 && own_until_px > 0)) return "the share of a camera's own view must be 0 to 1";
  return "";
}

MethodChoice chooseMethod(const std::vector<MethodScore>& scores, const LeftOut& views, const ChoiceRule& rule) {
  MethodChoice out;
  const double shift_px = views.shift_px, own_share = rule.own_share * std::max(0.0, 1 - shift_px / rule.own_until_px);
  for (const MethodScore& s : scores) {
    double judged_db = visitorsDb(s, own_share);
    if (trustsCalibration(s.method))
      judged_db += rule.search_db * std::clamp((views.gap_deg - kSmallGap_deg) / kSmallGap_deg, 0.0, 1.0);
    if (s.method == kLinear) judged_db -= rule.blend_db_per_px * shift_px;
    out.verdicts.push_back({s, judged_db, ""});
  }
  const auto linear = std::find_if(out.verdicts.begin(), out.verdicts.end(),
                                   [](const MethodVerdict& v) { return v.score.method == kLinear; });
  MethodVerdict* best = nullptr;
  for (MethodVerdict& v : out.verdicts) {
    if (v.score.cost > rule.most_cost)
      v.verdict = printed("costs %.1f × FVVR's frame", v.score.cost);
    else if (shift_px > rule.max_shift_px && trustsCalibration(v.score.method))
      v.verdict = printed("the cameras' pictures lie %.1f pixels off", shift_px);
    else if (linear != out.verdicts.end() && v.judged_db < linear->judged_db - rule.below_linear_db)
      v.verdict = printed("%.2f dB below linear", linear->judged_db - v.judged_db);
    else if (!best || v.judged_db > best->judged_db)
      best = &v;
  }
  if (!best) return out;
  MethodVerdict* taken = nullptr;
  for (MethodVerdict& v : out.verdicts) {
    const bool equal = v.verdict.empty() && v.judged_db >= best->judged_db - rule.tie_db &&
                       v.score.ssim >= best->score.ssim - rule.tie_ssim;
    if (equal && (!taken || v.score.cost < taken->score.cost)) taken = &v;
  }
  out.method = taken->score.method;
  for (MethodVerdict& v : out.verdicts)
    if (v.verdict.empty() && &v != taken) v.verdict = printed("%.2f dB below the best", best->judged_db - v.judged_db);
  taken->verdict = taken == best ? "taken" : "taken: as good as " + best->score.method + " and no dearer";
  return out;
}

namespace {

struct Cost {
  const char* method;
  double at[3];  // one per entry of kFaces
};

#include "bake/method/method_costs.inc"

}  // namespace

double methodCost(std::string_view method, size_t faces) {
  const auto row =
      std::find_if(std::begin(kCosts), std::end(kCosts), [&](const Cost& c) { return method == c.method; });
  if (row == std::end(kCosts)) return std::numeric_limits<double>::infinity();
  const double at = std::log(double(std::clamp(faces, kFaces[0], kFaces[2])));
  const size_t k = faces < kFaces[1] ? 0 : 1;
  const double low = std::log(double(kFaces[k])), high = std::log(double(kFaces[k + 1]));
  return std::max(1.0, row->at[k] + (row->at[k + 1] - row->at[k]) * (at - low) / (high - low));
}

bool trustsCalibration(std::string_view method) { return method == "sweep"; }

std::vector<std::string> methodCandidates() {
  std::vector<std::string> out;
  for (const Cost& cost : kCosts) out.emplace_back(cost.method);
  return out;
}

}  // namespace fourdvt::bake
