// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "lab/study/run/rows.h"
#include "lab/study/tables/report.h"

namespace fourdvt::study {
namespace {

constexpr const char* kMethodOrder[] = {
    rows::kFvvr,           rows::kFvvrGiven,     rows::kFvvrClosest, rows::kNaive,        rows::kSpatial,
    rows::kTemporalPaper,  rows::kPerTexel,      rows::kJoint,       rows::kJointDefault, rows::kJointNoUnseen,
    rows::kJointNoPartial, rows::kJointNeither,  rows::kAlignNone,   rows::kAlignBaked,   rows::kAlignBakedMean,
    rows::kFlowGpu,        rows::kFlowGpuDetail, rows::kFlowDis,     rows::kFlowOpencv,   rows::kOpencvDis};

size_t methodRank(const std::string& method) {
  return static_cast<size_t>(std::find(std::begin(kMethodOrder), std::end(kMethodOrder), method) -
                             std::begin(kMethodOrder));
}

void addOnce(std::vector<std::string>& list, const std::string& name) {
  if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
}

bool sameValue(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char *end_a = nullptr, *end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
  return !a.empty() && !b.empty() && *end_a == 0 && *end_b == 0 && x == y;
}

}  // namespace

bool matchesFilter(const std::string& setting, const std::string& filter) {
  std::istringstream pairs(filter);
  for (std::string pair; pairs >> pair;) {
    if (pair[0] == '!') {
      if (!rows::settingText(setting, pair.substr(1)).empty()) return false;
      continue;
    }
    const size_t equals = pair.find('=');
    if (!sameValue(rows::settingText(setting, pair.substr(0, equals)), pair.substr(equals + 1))) return false;
  }
  return true;
}

double StudyValues::of(const std::string& table, const std::string& sequence, const std::string& method,
                       const std::string& filter, const std::string& quantity) const {
  for (const Row& row : rows_)
    if (row.table == table && row.sequence == sequence && row.method == method && row.quantity == quantity &&
        matchesFilter(row.setting, filter))
      return row.value;
  return std::numeric_limits<double>::quiet_NaN();
}

double StudyValues::sum(const std::string& table, const std::string& method, const std::string& filter,
                        const std::string& quantity) const {
  const double whole = of(table, "", method, filter, quantity);
  if (!std::isnan(whole)) return whole;
  double total = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& sequence : sequences(table)) {
    const double value = of(table, sequence, method, filter, quantity);
    if (!std::isnan(value)) total = std::isnan(total) ? value : total + value;
  }
  return total;
}

double StudyValues::mean(const std::string& table, const std::string& method, const std::string& filter,
                         const std::string& quantity) const {
  const double whole = of(table, "", method, filter, quantity);
  if (!std::isnan(whole)) return whole;
  double total = 0;
  int count = 0;
  for (const std::string& sequence : sequences(table)) {
    const double value = of(table, sequence, method, filter, quantity);
    if (!std::isnan(value)) total += value, ++count;
  }
  return count ? total / count : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> StudyValues::sequences(const std::string& table) const {
  std::vector<std::string> out;
  for (const Row& row : rows_)
    if (row.table == table && !row.sequence.empty()) addOnce(out, row.sequence);
  return out;
}

std::vector<std::string> StudyValues::methods(const std::string& table) const {
  std::vector<std::string> out;
  for (const Row& row : rows_)
    if (row.table == table && !row.method.empty()) addOnce(out, row.method);
  std::stable_sort(out.begin(), out.end(),
                   [](const std::string& a, const std::string& b) { return methodRank(a) < methodRank(b); });
  return out;
}

std::vector<std::string> StudyValues::settings(const std::string& table, const std::string& method,
                                               const std::string& key) const {
  std::vector<std::string> out;
  for (const Row& row : rows_) {
    if (row.table != table || (!method.empty() && row.method != method)) continue;
    const std::string value = rows::settingText(row.setting, key);
    if (!value.empty()) addOnce(out, value);
  }
  return out;
}

std::vector<double> StudyValues::numbers(const std::string& table, const std::string& method,
                                         const std::string& key) const {
  std::vector<double> out;
  for (const std::string& text : settings(table, method, key)) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end == 0 && std::isfinite(value)) out.push_back(value);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::string methodTitle(const std::string& method) {
  if (method == rows::kFvvr) return "FVVR";
  if (method == rows::kFvvrGiven) return "FVVR, mesh and cameras as given";
  if (method == rows::kFvvrClosest) return "FVVR, M = " + std::to_string(rows::kClosestCameras);
  if (method == rows::kNaive) return "NO (naive)";
  if (method == rows::kSpatial) return "SO (spatial)";
  if (method == rows::kTemporalPaper) return "TO (Eq. 5)";
  if (method == rows::kPerTexel) return "per texel";
  if (method == rows::kJoint) return "ours (joint)";
  if (method == rows::kJointDefault) return "ours, default";
  if (method == rows::kJointNoUnseen) return "ours, unseen faces left empty";
  if (method == rows::kJointNoPartial) return "ours, no partial cameras";
  if (method == rows::kJointNeither) return "ours, neither";
  if (method == rows::kMethodLayered) return "layered";
  return method;
}

}  // namespace fourdvt::study
