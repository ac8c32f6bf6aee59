// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/colour_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "bake/texels/picture_crop.h"

namespace fourdvt::bake {
namespace {

constexpr size_t kMaxObservations = 60000;
constexpr size_t kMinObservations = 50;  // minimum per camera
constexpr float kMinFraction = 0.99f;    // minimum visible share of a face
constexpr double kFaceOnCosine = 0.5;    // between face normal and ray
constexpr double kScale = 0.02;          // residual beyond which an observation has less weight, in colour units
constexpr double kPriorShare = 4e-3;     // weight of the identity, as a share of a camera's mean number of observations
constexpr int kHuberIterations = 6, kIterations = 16;
constexpr uint8_t kClipped = 250;  // values from here on may be saturated

struct Sight {  // one camera's view of a face
  uint16_t camera;
  float cosine;
  std::array<glm::vec3, 4> colours;
};

uint64_t mix(uint64_t x) {  // finaliser of splitmix64 (G. Steele, D. Lea, C. Flood: Fast Splittable Pseudorandom Number
                            // Generators, OOPSLA 2014)
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// Samples bilinearly; empty unless all four pixels are opaque and unclipped.
std::optional<glm::vec3> sample(const Image& picture, const glm::dvec3& pixel) {
  const double fx = pixel.x - 0.5, fy = pixel.y - 0.5;
  const int x = int(std::floor(fx)), y = int(std::floor(fy));
  if (x < 0 || y < 0 || x + 1 >= picture.width || y + 1 >= picture.height) return {};
  glm::vec3 sum(0);
  for (int k = 0; k < 4; ++k) {
    const uint8_t* p = picture.at(x + (k & 1), y + (k >> 1));
    if ((picture.channels == 4 && p[3] < kOpaque) || std::max({p[0], p[1], p[2]}) >= kClipped) return {};
    const double weight = (k & 1 ? fx - x : 1 - (fx - x)) * (k >> 1 ? fy - y : 1 - (fy - y));
    sum += float(weight / 255) * glm::vec3(p[0], p[1], p[2]);
  }
  return sum;
}

// Samples the face's centre and three points half-way to its corners.
bool observe(const PinholeCamera& camera, const Image& picture, const glm::dvec3 (&corners)[3], Sight& out) {
  const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 pixel = camera.project(k == 3 ? centre : 0.5 * (centre + corners[k]));
    if (pixel.z <= 0) return false;
    const auto colour = sample(picture, pixel);
    if (!colour) return false;
    out.colours[k] = *colour;
  }
  return true;
}

// Huber's weight in the first iterations, then Geman and McClure's, which rejects outliers.
double robustWeight(double residual, int iteration) {
  const double ratio = residual / kScale;
  if (iteration < kHuberIterations) return std::min(1.0, 1 / std::max(ratio, 1e-9));
  return 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
}

// Solves a symmetric positive definite system in place by Cholesky decomposition; returns the solution in b.
void solveSystem(std::vector<double>& a, std::vector<double>& b) {
  const size_t n = b.size();
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j <= i; ++j) {
      double sum = a[i * n + j];
      for (size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      a[i * n + j] = i == j ? std::sqrt(std::max(sum, 1e-300)) : sum / a[j * n + j];
    }
  }
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
}

glm::vec3 apply(const ColourMap& map, const glm::vec3& colour) { return map.matrix * colour + map.offset; }

}  // namespace

void ColourCalibrator::add(std::span<const PinholeCamera> cameras, const MeshTopology& topology,
                           const Positions& positions, std::span<const float> fractions,
                           std::span<const Image> pictures) {
  const size_t faces = topology.faceCount();
  std::vector<glm::dvec3> centres;
  for (const PinholeCamera& camera : cameras) centres.push_back(camera.centreInWorld());
  std::vector<Sight> sights;
  for (size_t f = 0; f < faces; ++f) {
    const glm::uvec3 v = topology.face_vertices[f];
    const glm::dvec3 corners[3] = {glm::dvec3(positions[v.x]), glm::dvec3(positions[v.y]), glm::dvec3(positions[v.z])};
    const glm::dvec3 area_normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(area_normal);
    if (length < 1e-14) continue;
    const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    sights.clear();
    for (size_t c = 0; c < cameras.size(); ++c) {
      const double cosine = glm::dot(area_normal / length, glm::normalize(centres[c] - centre));
      if (fractions[c * faces + f] < kMinFraction || cosine < kFaceOnCosine) continue;
      Sight sight{static_cast<uint16_t>(c), float(cosine), {}};
      if (observe(cameras[c], pictures[c], corners, sight)) sights.push_back(sight);
    }
    for (size_t i = 0; i < sights.size(); ++i)
      for (size_t j = i + 1; j < sights.size(); ++j)
        for (int k = 0; k < 4; ++k)
          keep({sights[i].camera, sights[j].camera, sights[i].colours[k], sights[j].colours[k],
                sights[i].cosine * sights[j].cosine});
  }
}

// Keeps a uniform sample by reservoir sampling with a fixed pseudo-random sequence (Vitter's algorithm R).
void ColourCalibrator::keep(const Observation& observation) {
  const uint64_t index = seen_++;
  if (observations_.size() < kMaxObservations) {
    observations_.push_back(observation);
    return;
  }
  const uint64_t place = mix(index) % seen_;
  if (place < kMaxObservations) observations_[place] = observation;
}

// Least squares over the maps' deviations d from the identity: |(I + d_a) a - (I + d_b) b|², the channels' rows
// separate but with common robust weights; a stiff term holds the mean deviation at zero.
std::vector<ColourMap> ColourCalibrator::solve() const {
  std::vector<ColourMap> maps(camera_count_);
  std::vector<size_t> counts(camera_count_), unknown(camera_count_, SIZE_MAX);
  for (const Observation& o : observations_) ++counts[o.a], ++counts[o.b];
  size_t cameras = 0;
  for (size_t c = 0; c < camera_count_; ++c)
    if (counts[c] >= kMinObservations) unknown[c] = cameras++;
  if (cameras < 2) return maps;

  const size_t n = 4 * cameras;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<double> normal(n * n), right[3];
    for (auto& r : right) r.assign(n, 0);
    double total = 0;
    for (const Observation& o : observations_) {
      const size_t a = unknown[o.a], b = unknown[o.b];
      if (a == SIZE_MAX || b == SIZE_MAX) continue;
      const double residual = glm::length(apply(maps[o.a], o.colour_a) - apply(maps[o.b], o.colour_b));
      const double weight = o.weight * robustWeight(residual, iteration);
      total += weight;
      const double j[8] = {o.colour_a.x,  o.colour_a.y,  o.colour_a.z,  1,
                           -o.colour_b.x, -o.colour_b.y, -o.colour_b.z, -1};
      const glm::dvec3 difference(o.colour_b - o.colour_a);
      for (int p = 0; p < 8; ++p) {
        const size_t row = 4 * (p < 4 ? a : b) + p % 4;
        for (int q = 0; q < 8; ++q) normal[row * n + 4 * (q < 4 ? a : b) + q % 4] += weight * j[p] * j[q];
        for (int k = 0; k < 3; ++k) right[k][row] += weight * j[p] * difference[k];
      }
    }
    const double prior = kPriorShare * std::max(total, 1e-6) / double(cameras), stiff = 100 * std::max(total, 1e-6);
    for (size_t i = 0; i < n; ++i) {
      normal[i * n + i] += prior;
      for (size_t k = i % 4; k < n; k += 4) normal[i * n + k] += stiff;
    }
    for (int k = 0; k < 3; ++k) {
      std::vector<double> a = normal;
      solveSystem(a, right[k]);
    }
    for (size_t c = 0; c < camera_count_; ++c) {
      if (unknown[c] == SIZE_MAX) continue;
      for (int k = 0; k < 3; ++k) {
        const double* d = &right[k][4 * unknown[c]];
        for (int i = 0; i < 3; ++i) maps[c].matrix[i][k] = float(d[i] + (i == k));
        maps[c].offset[k] = float(d[3]);
      }
    }
  }
  return maps;
}

void applyColours(const ColourMap& map, Image& rgba) {
  const glm::vec3 offset = 255.0f * map.offset + 0.5f;
  for (size_t i = 0; i < rgba.pixels.size(); i += 4) {
    uint8_t* p = &rgba.pixels[i];
    if (p[3] == 0) continue;
    const glm::vec3 colour = glm::clamp(map.matrix * glm::vec3(p[0], p[1], p[2]) + offset, 0.0f, 255.0f);
    for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(colour[c]);
  }
}

}  // namespace fourdvt::bake
