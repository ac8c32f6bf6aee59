// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/step_phases.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {

std::vector<double> stepPhases(std::span<const uint32_t> frames, std::span<const double> source_frame,
                               uint32_t loop_frames, uint32_t phases) {
  std::vector<double> out;
  const auto nextFrame = [&](size_t p) {
    return p + 1 < source_frame.size() ? source_frame[p + 1] : source_frame[0] + loop_frames;
  };
  for (const uint32_t frame : frames) {
    for (size_t p = 0; p < source_frame.size(); ++p) {
      const double a = source_frame[p], b = nextFrame(p);
      double at = frame;
      if (loop_frames > 0)
        while (at < a - 1e-9) at += loop_frames;
      if (at < a - 1e-9 || !(at < b)) continue;
      out.push_back((double(p) + (at - a) / (b - a)) / phases);
      break;
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<double> meanSteps(const std::vector<std::vector<double>>& members, bool loop) {
  std::vector<double> out = members[0];
  for (const auto& member : members)
    if (member.size() != out.size()) return out;
  for (size_t i = 0; i < out.size(); ++i) {
    double sum = 0;
    for (const auto& member : members) {
      double nearest = 1;
      for (const double phase : member) {
        double away = phase - out[i];
        if (loop) away -= std::round(away);
        if (std::abs(away) < std::abs(nearest)) nearest = away;
      }
      sum += nearest;
    }
    out[i] += sum / double(members.size());
    if (loop) out[i] -= std::floor(out[i]);
    if (loop && out[i] >= 1) out[i] = 0;  // a rounding error below 0
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace fourdvt::bake
