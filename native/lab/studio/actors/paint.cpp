// SPDX-License-Identifier: Apache-2.0
// Paints clothes and skin on the atlas as functions of the rest pose, continuous across the atlas's seams.
#include <algorithm>
#include <cmath>
#include <optional>

#include "lab/studio/actors/body.h"

namespace fourdvt::studio {
namespace {

constexpr int kGutterTexels = 16;

double hash(int x, int y, int z) {
  uint32_t h = uint32_t(x) * 0x8da6b343u ^ uint32_t(y) * 0xd8163841u ^ uint32_t(z) * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return double((h ^ (h >> 15)) & 0xffff) / 0xffff;
}

// Trilinear value noise, 0..1; period 1 in every direction of `p`.
double noise(const glm::dvec3& p) {
  const glm::dvec3 base = glm::floor(p), f = (p - base) * (p - base) * (3.0 - 2.0 * (p - base));
  const glm::ivec3 i(base);
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 o(k & 1, k >> 1 & 1, k >> 2);
    const glm::dvec3 w = glm::mix(1.0 - f, f, glm::dvec3(o));
    sum += w.x * w.y * w.z * hash(i.x + o.x, i.y + o.y, i.z + o.z);
  }
  return sum;
}

// Grain of 40, 13 and 4 mm, -0.5..0.5.
double grain(const glm::dvec3& p) {
  return 0.4 * noise(25.0 * p) + 0.35 * noise(77.0 * p + 5.0) + 0.25 * noise(251.0 * p + 9.0) - 0.5;
}

double stripe(double x, double period, double width) {
  const double t = x / period - std::floor(x / period);
  const double edge = 0.08;
  return std::clamp((width / 2 - std::abs(t - 0.5)) / edge + 0.5, 0.0, 1.0);
}

glm::dvec3 plaid(const glm::dvec3& p) {
  glm::dvec3 c(0.62, 0.16, 0.15);
  c = glm::mix(c, glm::dvec3(0.12, 0.16, 0.36), 0.65 * stripe(p.x, 0.083, 0.42));
  c = glm::mix(c, glm::dvec3(0.10, 0.22, 0.20), 0.65 * stripe(p.y, 0.091, 0.40));
  c = glm::mix(c, glm::dvec3(0.85, 0.80, 0.62), 0.8 * stripe(p.x + 0.02, 0.083, 0.08));
  c = glm::mix(c, glm::dvec3(0.85, 0.80, 0.62), 0.8 * stripe(p.y + 0.03, 0.091, 0.08));
  return glm::mix(c, glm::dvec3(0.90, 0.65, 0.20), 0.7 * stripe(p.z + 0.01, 0.071, 0.10));
}

// Rows of random 3 × 5 glyphs: 1 on a glyph, else 0.
double glyph(double x, double y, double cell_m) {
  const double column = std::floor(x / cell_m), row = std::floor(y / (1.6 * cell_m));
  const double fx = x / cell_m - column, fy = y / (1.6 * cell_m) - row;
  const int i = static_cast<int>(fx * 4), j = static_cast<int>(fy * 6.5);
  if (i > 2 || j > 4) return 0;
  return hash(int(column) * 16 + i, int(row) * 16 + j, 7) > 0.45;
}

glm::dvec3 denim(const glm::dvec3& p) {
  const double weave = 0.5 + 0.5 * std::sin(900 * (p.x + p.y + 0.7 * p.z));
  glm::dvec3 c = glm::mix(glm::dvec3(0.16, 0.24, 0.42), glm::dvec3(0.30, 0.42, 0.62), noise(18.0 * p));
  c += 0.06 * (weave - 0.5);
  return glm::mix(c, glm::dvec3(0.75, 0.52, 0.25), 0.8 * stripe(p.z, 0.20, 0.03));
}

glm::dvec3 skin(const glm::dvec3& p) {
  const double freckles = noise(140.0 * p) > 0.78 ? 0.16 : 0.0;
  return glm::dvec3(0.80, 0.60, 0.50) + 0.10 * (noise(30.0 * p) - 0.5) - freckles;
}

glm::dvec3 face(const glm::dvec3& p) {
  if (p.y > 1.70 || (p.z < 0.0 && p.y > 1.52)) {
    const double strand = std::sin(400 * p.x + 6 * noise(40.0 * p));
    return glm::dvec3(0.28, 0.18, 0.10) + 0.08 * strand;
  }
  const double left = std::hypot(std::abs(p.x) - 0.035, p.y - 1.655), mouth = std::hypot(p.x / 2.2, p.y - 1.585);
  if (p.z > 0 && left < 0.012) return left < 0.006 ? glm::dvec3(0.05) : glm::dvec3(0.93);
  return p.z > 0 && mouth < 0.011 ? glm::dvec3(0.62, 0.22, 0.22) : skin(p);
}

constexpr glm::dvec3 kPlainShirt(0.55, 0.16, 0.15), kPlainTrousers(0.24, 0.33, 0.52), kPlainShoes(0.25, 0.16, 0.10);

// Colour of a plain garment; nullopt on the skin.
std::optional<glm::dvec3> plainClothesAt(const glm::dvec3& p) {
  switch (boneAt(p)) {
    case Head:
      return p.y < 1.46 ? std::optional(kPlainShirt) : std::nullopt;
    case HandL:
    case HandR:
      return std::nullopt;
    case FootL:
    case FootR:
      return kPlainShoes;
    case Pelvis:
    case ThighL:
    case ThighR:
    case ShinL:
    case ShinR:
      return kPlainTrousers;
    default:
      return kPlainShirt;
  }
}

glm::dvec3 colourAt(const glm::dvec3& p) {
  glm::dvec3 c;
  switch (boneAt(p)) {
    case Head:
      c = p.y < 1.46 ? plaid(p) : face(p);
      break;
    case HandL:
    case HandR:
      c = skin(p);
      break;
    case FootL:
    case FootR:
      c = glm::mix(glm::dvec3(0.25, 0.16, 0.10), glm::dvec3(0.80), stripe(p.z, 0.035, 0.25));
      break;
    case Pelvis:
    case ThighL:
    case ThighR:
    case ShinL:
    case ShinR:
      c = denim(p);
      if (glyph(p.x, p.y, 0.022) * stripe(p.y, 0.24, 0.5) > 0.5) c = glm::dvec3(0.86, 0.84, 0.78);
      break;
    default:
      c = plaid(p);
      if (glyph(p.x, p.y, 0.026) * stripe(p.y, 0.20, 0.4) > 0.5) c = glm::dvec3(0.95, 0.93, 0.86);
  }
  return glm::clamp(c * (1.0 + 0.45 * grain(p)), 0.0, 1.0);
}

class Painter {
 public:
  Painter(const RestMesh& mesh, int side, bool plain_clothes)
      : mesh_(mesh), plain_clothes_(plain_clothes), image_(side, side, 3, 0), covered_(size_t(side) * side, 0) {}

  Image run() {
    for (uint32_t f = 0; f < mesh_.topology.faceCount(); ++f) paint(f);
    for (int i = 0; i < kGutterTexels; ++i) grow();
    return std::move(image_);
  }

 private:
  void paint(uint32_t f) {
    const int side = image_.width;
    glm::dvec2 uv[3];
    for (int k = 0; k < 3; ++k) uv[k] = glm::dvec2(mesh_.topology.uvs[mesh_.topology.face_uvs[f][k]]) * double(side);
    const glm::uvec3& v = mesh_.topology.face_vertices[f];
    const glm::dvec2 low = glm::min(uv[0], glm::min(uv[1], uv[2])), high = glm::max(uv[0], glm::max(uv[1], uv[2]));
    const double area = cross(uv[1] - uv[0], uv[2] - uv[0]);
    if (area == 0) return;
    constexpr double slack = -1e-6;
    for (int y = std::max(0, int(low.y - 0.5)); y <= std::min(side - 1, int(high.y)); ++y)
      for (int x = std::max(0, int(low.x - 0.5)); x <= std::min(side - 1, int(high.x)); ++x) {
        const glm::dvec2 p(x + 0.5, y + 0.5);
        const double b = cross(p - uv[0], uv[2] - uv[0]) / area, c = cross(uv[1] - uv[0], p - uv[0]) / area;
        if (b < slack || c < slack || b + c > 1 - slack) continue;
        const glm::dvec3 at = (1 - b - c) * glm::dvec3(mesh_.positions[v.x]) + b * glm::dvec3(mesh_.positions[v.y]) +
                              c * glm::dvec3(mesh_.positions[v.z]);
        const auto plain = plain_clothes_ ? plainClothesAt(at) : std::nullopt;
        const glm::dvec3 colour = plain ? *plain : colourAt(at);
        for (int k = 0; k < 3; ++k) image_.at(x, y)[k] = static_cast<uint8_t>(255 * colour[k] + 0.5);
        covered_[size_t(y) * side + x] = 1;
      }
  }

  static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

  // Grows the paint by one texel: each new texel is the mean of its covered neighbours.
  void grow() {
    const int side = image_.width;
    const std::vector<uint8_t> before = covered_;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        if (before[size_t(y) * side + x]) continue;
        int sum[3] = {0, 0, 0}, count = 0;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int nx = x + dx, ny = y + dy;
          if (nx < 0 || ny < 0 || nx >= side || ny >= side || !before[size_t(ny) * side + nx]) continue;
          for (int k = 0; k < 3; ++k) sum[k] += image_.at(nx, ny)[k];
          ++count;
        }
        if (!count) continue;
        for (int k = 0; k < 3; ++k) image_.at(x, y)[k] = static_cast<uint8_t>(sum[k] / count);
        covered_[size_t(y) * side + x] = 1;
      }
  }

  const RestMesh& mesh_;
  const bool plain_clothes_;
  Image image_;
  std::vector<uint8_t> covered_;
};

}  // namespace

Image paintBody(const RestMesh& mesh, int side, bool plain_clothes) { return Painter(mesh, side, plain_clothes).run(); }

}  // namespace fourdvt::studio
