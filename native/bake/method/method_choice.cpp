// SPDX-License-Identifier: Apache-2.0
#include "bake/method/method_choice.h"

#include <cstdio>

#include "bake/method/method_costs.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kLinear = "linear";

std::string text(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

}  // namespace

std::string ChoiceRule::check() const {
  if (!(most_cost >= 1 && most_cost <= 100)) return "method cost must be 1..100 frames of fvvr";
  if (!(below_linear_db >= 0 && tie_db >= 0 && tie_ssim >= 0)) return "margins of the method must not be negative";
  return "";
}

MethodChoice chooseMethod(const std::vector<MethodScore>& scores, double shift_px, const ChoiceRule& rule) {
  MethodChoice out;
  const MethodScore* linear = nullptr;
  for (const MethodScore& s : scores)
    if (s.method == kLinear) linear = &s;
  std::vector<const MethodScore*> left;
  for (const MethodScore& s : scores) {
    std::string verdict;
    if (s.cost > rule.most_cost)
      verdict = text("costs %.1f × FVVR's frame", s.cost);
    else if (shift_px > rule.most_shift_px && trustsCalibration(s.method))
      verdict = text("the cameras' pictures lie %.1f pixels off", shift_px);
    else if (linear && s.psnr_db < linear->psnr_db - rule.below_linear_db)
      verdict = text("%.2f dB below linear", linear->psnr_db - s.psnr_db);
    else
      left.push_back(&s);
    out.verdicts.push_back({s, verdict});
  }
  if (left.empty()) return out;
  const MethodScore* best = left.front();
  for (const MethodScore* s : left)
    if (s->psnr_db > best->psnr_db) best = s;
  const MethodScore* taken = nullptr;
  for (const MethodScore* s : left) {
    const bool equal = s->psnr_db >= best->psnr_db - rule.tie_db && s->ssim >= best->ssim - rule.tie_ssim;
    if (equal && (!taken || s->cost < taken->cost)) taken = s;
  }
  out.method = taken->method;
  for (MethodVerdict& v : out.verdicts) {
    if (!v.verdict.empty()) continue;
    if (v.score.method == taken->method)
      v.verdict = taken == best ? "taken" : "taken: as good as " + best->method + " and no dearer";
    else
      v.verdict = text("%.2f dB below the best", best->psnr_db - v.score.psnr_db);
  }
  return out;
}

}  // namespace fourdvt::bake
