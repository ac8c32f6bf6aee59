// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <sstream>

#include "lab/study/run/rows.h"
#include "lab/study/tables/report.h"

namespace fourdvt::study {
namespace {

using namespace rows;

// Methods in the report's order, with their titles.
const std::pair<std::string, std::string> kMethods[] = {{kFvvr, "FVVR"},
                                                        {kFvvrTuned, "FVVR at its best"},
                                                        {kFvvrGiven, "FVVR, mesh and cameras as given"},
                                                        {kFvvrClosest, "FVVR, M = " + std::to_string(kClosestCameras)},
                                                        {kNaive, "NO (naive)"},
                                                        {kSpatial, "SO (spatial)"},
                                                        {kTemporalPaper, "TO (Eq. 5)"},
                                                        {kPerTexel, "per texel"},
                                                        {kJoint, "ours (joint)"},
                                                        {kJointDefault, "ours, default"},
                                                        {kJointNoUnseen, "ours, unseen faces left empty"},
                                                        {kJointNoPartial, "ours, no partial cameras"},
                                                        {kJointNeither, "ours, neither"},
                                                        {kAlignNone, kAlignNone},
                                                        {kAlignBaked, kAlignBaked},
                                                        {kAlignBakedMean, kAlignBakedMean},
                                                        {kFlowGpu, kFlowGpu},
                                                        {kFlowGpuDetail, kFlowGpuDetail},
                                                        {kFlowDis, kFlowDis},
                                                        {kFlowOpencv, kFlowOpencv},
                                                        {kOpencvDis, kOpencvDis}};

const auto* known(const std::string& method) {
  return std::find_if(std::begin(kMethods), std::end(kMethods), [&](const auto& m) { return m.first == method; });
}

// Distinct texts of a table's rows in order of appearance, without empty ones.
template <class Text>
std::vector<std::string> distinct(const Rows& rows, const std::string& table, Text text) {
  std::vector<std::string> out;
  for (const Row& row : rows) {
    if (row.table != table) continue;
    const std::string name = std::invoke(text, row);
    if (!name.empty() && std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  }
  return out;
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
      if (!settingText(setting, pair.substr(1)).empty()) return false;
      continue;
    }
    const size_t equals = pair.find('=');
    const std::string key = pair.substr(0, equals);
    std::string wanted = pair.substr(equals + 1), rest;
    if (isLastKey(key) && std::getline(pairs, rest)) wanted += rest;
    if (!sameValue(settingText(setting, key), wanted)) return false;
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

std::vector<double> StudyValues::each(const std::string& table, const std::string& method, const std::string& filter,
                                      const std::string& quantity) const {
  const double whole = of(table, "", method, filter, quantity);
  if (!std::isnan(whole)) return {whole};
  std::vector<double> out;
  for (const std::string& sequence : sequences(table)) out.push_back(of(table, sequence, method, filter, quantity));
  std::erase_if(out, [](double value) { return std::isnan(value); });
  return out;
}

double StudyValues::sum(const std::string& table, const std::string& method, const std::string& filter,
                        const std::string& quantity) const {
  const std::vector<double> values = each(table, method, filter, quantity);
  return values.empty() ? std::nan("") : std::accumulate(values.begin(), values.end(), 0.0);
}

double StudyValues::mean(const std::string& table, const std::string& method, const std::string& filter,
                         const std::string& quantity) const {
  const std::vector<double> values = each(table, method, filter, quantity);
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());  // NaN for none
}

std::vector<std::string> StudyValues::sequences(const std::string& table) const {
  return distinct(rows_, table, &Row::sequence);
}

std::vector<std::string> StudyValues::methods(const std::string& table) const {
  std::vector<std::string> out = distinct(rows_, table, &Row::method);
  std::stable_sort(out.begin(), out.end(),
                   [](const std::string& a, const std::string& b) { return known(a) < known(b); });
  return out;
}

std::vector<std::string> StudyValues::settings(const std::string& table, const std::string& method,
                                               const std::string& key) const {
  return distinct(rows_, table, [&](const Row& row) {
    return method.empty() || row.method == method ? settingText(row.setting, key) : std::string();
  });
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
  const auto* found = known(method);
  return found == std::end(kMethods) ? method : found->second;
}

}  // namespace fourdvt::study
