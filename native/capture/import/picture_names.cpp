// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "capture/import/views.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxDigits = 18;        // capacity of an int64_t
constexpr size_t kDigitsOfSeconds = 9;   // minimum: seconds since 1970, from 2001 on
constexpr size_t kDigitsOfFraction = 9;  // nanoseconds

// Name cut into digits and the parts between them.
struct NameParts {
  std::vector<std::string> digits;
  std::vector<std::string> between;  // one element more than digits
};

NameParts partsOf(const std::string& name) {
  NameParts out{{}, {""}};
  bool in_digits = false;
  for (const char c : name) {
    if (isDigit(c) && !in_digits) out.digits.emplace_back();
    if (!isDigit(c) && in_digits) out.between.emplace_back();
    in_digits = isDigit(c);
    (in_digits ? out.digits.back() : out.between.back()) += c;
  }
  if (in_digits) out.between.emplace_back();
  return out;
}

int64_t numberOf(const std::string& digits) {
  int64_t number = 0;
  for (const char c : digits.substr(0, kMaxDigits)) number = 10 * number + (c - '0');
  return number;
}

int64_t lastNumber(const NameParts& parts) { return parts.digits.empty() ? -1 : numberOf(parts.digits.back()); }

std::vector<int64_t> lastNumbers(const std::vector<NameParts>& names) {
  std::vector<int64_t> out;
  for (const NameParts& parts : names) out.push_back(lastNumber(parts));
  return out;
}

bool alike(const std::vector<NameParts>& names) {
  return std::all_of(names.begin(), names.end(), [&](const NameParts& parts) {
    return parts.between == names[0].between && !parts.digits.empty();
  });
}

bool allHave(const std::vector<NameParts>& names, size_t group, size_t min_digits, size_t max_digits) {
  return std::all_of(names.begin(), names.end(), [&](const NameParts& parts) {
    const size_t digits = parts.digits[group].size();
    return digits >= min_digits && digits <= max_digits;
  });
}

// Groups whose digits differ between the names.
std::vector<size_t> varyingGroups(const std::vector<NameParts>& names) {
  std::vector<size_t> out;
  for (size_t g = 0; g < names[0].digits.size(); ++g)
    if (std::any_of(names.begin(), names.end(), [&](const auto& n) { return n.digits[g] != names[0].digits[g]; }))
      out.push_back(g);
  return out;
}

// Returns true if group `g` is the fraction of the seconds before it: after a point, or in digits of milli-, micro- or
// nanoseconds.
bool isFraction(const std::vector<NameParts>& names, size_t g, bool seconds_vary) {
  if (g == 0 || !allHave(names, g, 1, kDigitsOfFraction)) return false;
  const bool of_clock = allHave(names, g - 1, kDigitsOfSeconds, kDigitsOfSeconds + 1);
  const std::string& sign = names[0].between[g];
  if (sign == ".") return of_clock || seconds_vary;
  const size_t digits = names[0].digits[g].size();
  return of_clock && (sign == "_" || sign == "-") && digits % 3 == 0 && allHave(names, g, digits, digits);
}

int64_t nanoseconds(const std::string& seconds, std::string fraction) {
  fraction.resize(kDigitsOfFraction, '0');
  const uint64_t whole = static_cast<uint64_t>(numberOf(seconds));  // wraps beyond the year 2262
  return static_cast<int64_t>((whole * 1'000'000'000u + static_cast<uint64_t>(numberOf(fraction))) & INT64_MAX);
}

// All groups as one number; each group has equally many digits in every name.
std::vector<int64_t> joined(const std::vector<NameParts>& names, const std::vector<size_t>& groups) {
  size_t digits = 0;
  for (const size_t g : groups) {
    const size_t here = names[0].digits[g].size();
    if (!allHave(names, g, here, here)) return lastNumbers(names);
    digits += here;
  }
  if (digits > kMaxDigits) return lastNumbers(names);
  std::vector<int64_t> out;
  for (const NameParts& parts : names) {
    std::string all;
    for (const size_t g : groups) all += parts.digits[g];
    out.push_back(numberOf(all));
  }
  return out;
}

}  // namespace

std::vector<int64_t> pictureNumbers(const std::vector<std::string>& names) {
  std::vector<NameParts> parts;
  for (const std::string& name : names) parts.push_back(partsOf(name));
  if (names.empty() || !alike(parts)) return lastNumbers(parts);
  const std::vector<size_t> groups = varyingGroups(parts);
  const size_t last = groups.empty() ? parts[0].digits.size() - 1 : groups.back();
  const bool pair = groups.size() == 2 && groups[0] + 1 == groups[1];
  if ((groups.size() <= 1 || pair) && isFraction(parts, last, pair)) {
    std::vector<int64_t> out;
    for (const NameParts& name : parts) out.push_back(nanoseconds(name.digits[last - 1], name.digits[last]));
    return out;
  }
  if (groups.size() > 1) return joined(parts, groups);
  std::vector<int64_t> out;
  for (const NameParts& name : parts) out.push_back(numberOf(name.digits[last]));
  return out;
}

}  // namespace fourdvt::capture
