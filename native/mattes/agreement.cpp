// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "mattes/support.h"

namespace fourdvt::mattes {
namespace {

constexpr double kEnough = 0.85;  // minimum explained share of the silhouettes; the rest may be shadows and bystanders
constexpr double kGain = 0.1;     // minimum gain of the others' agreement without a camera, for naming it
constexpr double kHopeless = 0.5;
constexpr double kSlackShare =
    0.006;  // share of the picture's longer side; tolerates small errors of calibration, time and mattes

std::string percent(double share) { return std::to_string(int(std::lround(100 * share))) + " %"; }

// Mean of `value` over all cameras except `but`; skips NaN.
template <class Value>
double meanOfOthers(size_t cameras, size_t but, Value value) {
  double sum = 0, count = 0;
  for (size_t j = 0; j < cameras; ++j)
    if (const double v = j == but ? NAN : value(j); !std::isnan(v)) sum += v, ++count;
  return count > 0 ? sum / count : NAN;
}

}  // namespace

std::optional<std::string> disagreement(const std::vector<capture::CaptureCamera>& cameras,
                                        const std::vector<cv::Mat>& masks) {
  int longest = 0;
  for (const capture::CaptureCamera& c : cameras) longest = std::max({longest, c.pinhole.width, c.pinhole.height});
  const SupportFinder finder(cameras, 0);
  const auto explained = finder.explain(masks, std::max(3.0, kSlackShare * longest));
  size_t judged = 0, worst = 0;
  double gain = 0, lowest = 1;
  size_t outsider = cameras.size();
  for (size_t i = 0; i < cameras.size(); ++i) {
    const double share = explained.share[i];
    if (std::isnan(share)) continue;
    ++judged;
    const double with = meanOfOthers(cameras.size(), i, [&](size_t j) { return explained.share[j]; });
    const double without = meanOfOthers(cameras.size(), i, [&](size_t j) { return explained.without[j][i]; });
    if (without - with > gain) gain = without - with, worst = i;
    if (share < lowest) lowest = share, outsider = i;
  }
  if (judged < 3) return std::nullopt;
  const double mean = meanOfOthers(cameras.size(), cameras.size(), [&](size_t j) { return explained.share[j]; });
  if (mean >= kEnough && lowest >= kHopeless) return std::nullopt;
  const double with = meanOfOthers(cameras.size(), worst, [&](size_t j) { return explained.share[j]; });
  if (gain >= kGain && with + gain >= kHopeless) {
    return "the silhouette of camera \"" + cameras[worst].pinhole.name +
           "\" does not fit the others': " + percent(with) + " of theirs lie in a common volume with it, " +
           percent(with + gain) + " without it";
  }
  if (lowest < kHopeless && mean >= kHopeless)
    return "the silhouette of camera \"" + cameras[outsider].pinhole.name + "\" does not fit the others': only " +
           percent(lowest) + " of it lie in a common volume with theirs";
  if (mean >= kEnough) return std::nullopt;
  return "no common volume explains the silhouettes: only " + percent(mean) +
         " of their pixels lie in one, and leaving out any one camera does not mend it";
}

}  // namespace fourdvt::mattes
