// SPDX-License-Identifier: Apache-2.0
// Shapes with analytic motion: a bending tube, and a walker of three boxes.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "bake/motion/class_plan.h"

namespace fourdvt {

constexpr double kTau = 2 * std::numbers::pi;

// Tube along y, of length 1, open at both ends.
struct Tube {
  static constexpr int kRings = 41, kSides = 12;
  static constexpr float kRadius = 0.06f;
  MeshTopology topology;

  Tube() {
    topology.vertex_count = kRings * kSides;
    topology.uvs = {{0, 0}, {1, 0}, {0, 1}};
    for (uint32_t r = 0; r + 1 < kRings; ++r) {
      for (uint32_t s = 0; s < kSides; ++s) {
        const uint32_t a = r * kSides + s, b = r * kSides + (s + 1) % kSides;
        topology.face_vertices.insert(topology.face_vertices.end(), {{a, a + kSides, b}, {b, a + kSides, b + kSides}});
      }
    }
    topology.face_uvs.assign(topology.face_vertices.size(), {0, 1, 2});
  }

  // Tube bent to an arc of `angle` towards +x; its foot stays.
  static Positions bent(double angle) {
    Positions out;
    for (int r = 0; r < kRings; ++r) {
      const double y = double(r) / (kRings - 1), turn = angle * y;
      const double radius = std::abs(angle) > 1e-9 ? 1 / angle : 0;
      const double x0 = radius * (1 - std::cos(turn)), y0 = radius != 0 ? radius * std::sin(turn) : y;
      for (int s = 0; s < kSides; ++s) {
        const double around = kTau * s / kSides, out_x = kRadius * std::cos(around);
        out.emplace_back(x0 + out_x * std::cos(turn), y0 - out_x * std::sin(turn), kRadius * std::sin(around));
      }
    }
    return out;
  }
  // Length of the polyline through the rings' centres.
  static double length(const Positions& p) {
    double length = 0;
    glm::vec3 before(0);
    for (int r = 0; r < kRings; ++r) {
      glm::vec3 middle(0);
      for (int s = 0; s < kSides; ++s) middle += p[size_t(r * kSides + s)] / float(kSides);
      if (r > 0) length += glm::distance(middle, before);
      before = middle;
    }
    return length;
  }
};

inline glm::vec3 meanOf(const Positions& p) {
  glm::dvec3 sum(0);
  for (const glm::vec3& v : p) sum += glm::dvec3(v);
  return glm::vec3(sum / double(p.size()));
}

inline double largestDistance(const Positions& a, const Positions& b) {
  double most = 0;
  for (size_t v = 0; v < a.size(); ++v) most = std::max(most, double(glm::distance(a[v], b[v])));
  return most;
}

// Body with two feet on a treadmill: a standing foot moves back with the ground, then swings forwards. Speed over the
// ground v(u) = speed * (1 + sway * sin 2τu), with mean `speed` over a pass.
struct Walker {
  capture::Capture capture;
  capture::CaptureSequence sequence;
  double speed_mps, sway;
  double first_share = 0;  // share of the pass at frame 0

  Walker(const std::string& name, double speed, uint32_t frames, double sway_of_speed = 0)
      : speed_mps(speed), sway(sway_of_speed) {
    capture.fps = 25;
    capture.topology = topology();
    sequence.name = name;
    sequence.frame_count = frames;
    sequence.loop = true;
    sequence.root_velocity_mps = {0, 0, speed};
  }
  double duration_s() const { return sequence.frame_count / 25.0; }
  // Metres travelled since u = 0.
  double travelled(double u) const {
    return speed_mps * duration_s() * (u + sway * (1 - std::cos(2 * kTau * u)) / (2 * kTau));
  }
  // z and height of a foot that stands from u = 0 to 0.5 of its step, which begins `phase` later.
  glm::vec2 foot(double u, double phase) const {
    const double at = u - phase - std::floor(u - phase);
    const double from = phase, step = travelled(from + 1) - travelled(from);
    if (at <= 0.5) return {-(travelled(from + at) - travelled(from)) + 0.25 * step, 0};
    const double swing = (at - 0.5) / 0.5, back = travelled(from + 0.5) - travelled(from);
    return {-back + 0.25 * step + back * (1 - std::cos(swing * kTau / 2)) / 2, 0.15 * std::sin(swing * kTau / 2)};
  }
  Positions pose(double share) const {
    const double u = share + first_share;
    Positions out;
    const glm::vec2 left = foot(u, 0), right = foot(u, 0.5);
    addBox(out, {0.1, left.y, left.x}, {0.05, 0.06, 0.12});
    addBox(out, {-0.1, right.y, right.x}, {0.05, 0.06, 0.12});
    addBox(out, {0, 0.8, 0.05 * std::sin(2 * kTau * u)}, {0.2, 0.6, 0.15});
    return out;
  }
  Positions frame(uint32_t t) const { return pose(double(t) / sequence.frame_count); }

  static MeshTopology topology() {
    MeshTopology t;
    t.vertex_count = 24;
    t.uvs = {{0, 0}, {1, 0}, {0, 1}};
    const uint32_t quads[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (uint32_t box = 0; box < 24; box += 8)
      for (const auto& q : quads)
        t.face_vertices.insert(t.face_vertices.end(),
                               {glm::uvec3(q[0], q[1], q[2]) + box, glm::uvec3(q[0], q[2], q[3]) + box});
    t.face_uvs.assign(t.face_vertices.size(), {0, 1, 2});
    return t;
  }

 private:
  static void addBox(Positions& out, const glm::dvec3& base, const glm::dvec3& size) {
    for (int i = 0; i < 8; ++i)
      out.emplace_back(base + size * glm::dvec3((i & 1) - 0.5, (i >> 1) & 1, ((i >> 2) & 1) - 0.5));
  }
};

}  // namespace fourdvt
