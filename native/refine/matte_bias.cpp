// SPDX-License-Identifier: Apache-2.0
#include "refine/matte_bias.h"

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>

#include "base/srgb.h"

namespace fourdvt::refine {
namespace {

constexpr float kInner = 4, kOuter = 7;  // pixels from the matte's edge
constexpr float kContrast = 0.06f;       // smallest distance of the two colours, linear light
constexpr float kReach = 4;              // pixels; an edge further off is not this matte's

struct LinearLight {
  std::array<float, 256> of;
  LinearLight() {
    for (int i = 0; i < 256; ++i) of[size_t(i)] = linearFromSrgb(float(i) / 255);
  }
};

class Profile {
 public:
  Profile(const Image& rgba, glm::vec2 origin, glm::vec2 outward) : rgba_(rgba), origin_(origin), outward_(outward) {}
  // Linear colour and matte (0…1).
  glm::vec4 at(float t) const {
    static const LinearLight linear;
    const glm::vec2 p = origin_ + t * outward_ - 0.5f;
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    const float u = p.x - float(x), v = p.y - float(y);
    glm::vec4 sum(0);
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const uint8_t* q = rgba_.at(x + i, y + j);
        sum += (i ? u : 1 - u) * (j ? v : 1 - v) *
               glm::vec4(linear.of[q[0]], linear.of[q[1]], linear.of[q[2]], float(q[3]) / 255);
      }
    return sum;
  }
  glm::vec3 mean(float from, float to) const {
    glm::vec3 sum(0);
    constexpr int kTaps = 4;
    for (int i = 0; i < kTaps; ++i) sum += glm::vec3(at(from + (to - from) * float(i) / (kTaps - 1)));
    return sum / float(kTaps);
  }

 private:
  const Image& rgba_;
  const glm::vec2 origin_, outward_;
};

// Where `value` falls through one half on the way out, nearest to 0.
template <class Value>
std::optional<float> crossing(const Value& value, float reach) {
  constexpr float kStep = 0.25f;
  std::optional<float> best;
  float before = value(-reach);
  for (float t = -reach; t < reach; t += kStep) {
    const float after = value(t + kStep);
    if (before >= 0.5f && after < 0.5f) {
      const float at = t + kStep * (before - 0.5f) / (before - after);
      if (!best || std::abs(at) < std::abs(*best)) best = at;
    }
    before = after;
  }
  return best;
}

std::optional<double> offsetAt(const Image& rgba, int x, int y) {
  const auto alpha = [&](int i, int j) { return float(rgba.at(i, j)[3]); };
  const glm::vec2 gradient(alpha(x + 1, y) - alpha(x - 1, y), alpha(x, y + 1) - alpha(x, y - 1));
  const float length = glm::length(gradient);
  if (length < 64) return std::nullopt;
  const Profile profile(rgba, glm::vec2(x + 0.5f, y + 0.5f), -gradient / length);
  const auto matte_edge = crossing([&](float t) { return profile.at(t).a; }, 1.5f);
  if (!matte_edge) return std::nullopt;
  const float m = *matte_edge;
  if (profile.at(m - kInner).a < 0.95f || profile.at(m - kOuter).a < 0.95f) return std::nullopt;
  if (profile.at(m + kInner).a > 0.05f || profile.at(m + kOuter).a > 0.05f) return std::nullopt;
  const glm::vec3 figure = profile.mean(m - kOuter, m - kInner), background = profile.mean(m + kInner, m + kOuter);
  const glm::vec3 between = figure - background;
  const float squared = glm::dot(between, between);
  if (squared < kContrast * kContrast) return std::nullopt;
  const auto picture_edge =
      crossing([&](float t) { return glm::dot(glm::vec3(profile.at(m + t)) - background, between) / squared; }, kReach);
  if (!picture_edge) return std::nullopt;
  return -double(*picture_edge);
}

}  // namespace

std::vector<double> matteEdgeOffsets(const Image& rgba, int stride) {
  const int margin = int(kOuter + kReach) + 3;
  std::vector<double> out;
  int seen = 0;
  for (int y = margin; y < rgba.height - margin; ++y)
    for (int x = margin; x < rgba.width - margin; ++x) {
      const uint8_t here = rgba.at(x, y)[3];
      // A pixel beside the edge: at least half inside, with a neighbour that is not.
      if (here < 128) continue;
      if (rgba.at(x + 1, y)[3] >= 128 && rgba.at(x - 1, y)[3] >= 128 && rgba.at(x, y + 1)[3] >= 128 &&
          rgba.at(x, y - 1)[3] >= 128)
        continue;
      if (seen++ % stride) continue;
      if (const auto offset = offsetAt(rgba, x, y)) out.push_back(*offset);
    }
  return out;
}

}  // namespace fourdvt::refine
