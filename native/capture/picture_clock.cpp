// SPDX-License-Identifier: Apache-2.0
#include "capture/picture_clock.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/text.h"

namespace fourdvt::capture {
namespace {

constexpr double kMaxGaps = 0.1;  // share of the pictures

double medianInterval(const std::vector<double>& times_s) {
  std::vector<double> intervals;
  for (size_t i = 1; i < times_s.size(); ++i) intervals.push_back(times_s[i] - times_s[i - 1]);
  const auto middle = intervals.begin() + static_cast<ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

// Half the range of the pictures' deviations from their instants, in steps.
double maxOff(const std::vector<double>& times_s, const PictureClock& clock) {
  double least = 0, most = 0;
  for (size_t i = 0; i < times_s.size(); ++i) {
    const double off = (times_s[i] - times_s[0]) / clock.step_s - double(clock.instants[i]);
    least = std::min(least, off), most = std::max(most, off);
  }
  return (most - least) / 2;
}

}  // namespace

std::optional<PictureClock> clockOf(const std::vector<double>& times_s) {
  PictureClock clock;
  if (times_s.empty()) return std::nullopt;
  clock.instants.push_back(0);
  if (times_s.size() == 1) return clock;
  const double median = medianInterval(times_s);
  if (!(median > 0)) return std::nullopt;
  for (size_t i = 1; i < times_s.size(); ++i) {
    const double steps = std::round((times_s[i] - times_s[i - 1]) / median);
    if (!(steps >= 1) || steps > 1e9) return std::nullopt;
    clock.instants.push_back(clock.instants.back() + static_cast<int64_t>(steps));
  }
  const double span = double(clock.instants.back());
  clock.step_s = (times_s.back() - times_s.front()) / span;
  clock.max_off = maxOff(times_s, clock);
  const size_t gaps = gapsOf(clock, 0, times_s.size()).size();
  if (clock.max_off > 0.5 || double(gaps) > std::max(1.0, kMaxGaps * double(times_s.size()))) return std::nullopt;
  return clock;
}

std::vector<ClockGap> gapsOf(const PictureClock& clock, size_t begin, size_t end) {
  std::vector<ClockGap> out;
  for (size_t i = begin + 1; i < std::min(end, clock.instants.size()); ++i) {
    const int64_t lost = clock.instants[i] - clock.instants[i - 1] - 1;
    if (lost > 0) out.push_back({i - 1, uint64_t(lost), double(clock.instants[i - 1] + 1) * clock.step_s});
  }
  return out;
}

std::string constantRateCommand(const std::string& path, double fps) {
  const std::string rate = printed("%.6g", fps);
  const std::filesystem::path file(path);
  const bool webm = file.extension() == ".webm";  // WebM may have alpha
  const std::string name = file.filename().string(),
                    made = file.stem().string() + "_" + rate + (webm ? ".webm" : ".mp4");
  return std::string("ffmpeg -noautorotate ") + (webm ? "-c:v libvpx-vp9 " : "") + "-i " + name + " -vf fps=" + rate +
         " -an " +
         (webm ? "-c:v libvpx-vp9 -crf 14 -b:v 0 -pix_fmt yuva420p " : "-c:v libx264 -crf 14 -pix_fmt yuv420p ") +
         made + ", and take " + name + " away";
}

}  // namespace fourdvt::capture
