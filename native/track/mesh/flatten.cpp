// SPDX-License-Identifier: Apache-2.0
// Sources: William T. Tutte: How to Draw a Graph. Proceedings of the London Mathematical Society 13, 1963 (the start);
// Ligang Liu, Lei Zhang, Yin Xu, Craig Gotsman, Steven J. Gortler: A Local/Global Approach to Mesh Parameterization.
// Computer Graphics Forum 27(5), 2008 (as rigid as possible).
#include <Eigen/SparseCholesky>
#include <cmath>

#include "track/mesh/patch.h"
#include "track/mesh/triangle.h"

namespace fourdvt::track {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<SparseMatrix>;
using Plane = Eigen::Matrix<double, Eigen::Dynamic, 2>;

constexpr double kPin = 1e-6;  // weight that holds the first vertex, against weights near 1

void addSpring(std::vector<Eigen::Triplet<double>>& entries, uint32_t a, uint32_t b, double weight) {
  entries.emplace_back(int(a), int(a), weight);
  entries.emplace_back(int(b), int(b), weight);
  entries.emplace_back(int(a), int(b), -weight);
  entries.emplace_back(int(b), int(a), -weight);
}

SparseMatrix matrixOf(size_t size, const std::vector<Eigen::Triplet<double>>& entries) {
  SparseMatrix matrix(Eigen::Index(size), static_cast<Eigen::Index>(size));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

void startOnCircle(const Surface& s, Patch& patch) {
  double length = 0, area = 0;
  for (const uint32_t h : patch.border) length += s.length(h);
  for (const uint32_t f : patch.faces) area += s.areas[f];
  const double radius = std::sqrt(std::max(area, 1e-12) / 3.14159265), stiff = 1e6;
  std::vector<Eigen::Triplet<double>> entries;
  for (const glm::uvec3& c : patch.corners)
    for (int k = 0; k < 3; ++k) addSpring(entries, c[k], c[(k + 1) % 3], 1);
  Plane right = Plane::Zero(int(patch.vertices.size()), 2);
  double along = 0;
  for (size_t i = 0; i < patch.border.size(); ++i) {
    const int v = int(patch.border_vertices[i]);
    const double angle = 6.28318531 * (length > 0 ? along / length : double(i) / double(patch.border.size()));
    along += s.length(patch.border[i]);
    entries.emplace_back(v, v, stiff);
    right(v, 0) = stiff * radius * std::cos(angle);
    right(v, 1) = stiff * radius * std::sin(angle);
  }
  const Plane found = Solver(matrixOf(patch.vertices.size(), entries)).solve(right);
  patch.flat.resize(patch.vertices.size());
  for (int v = 0; v < found.rows(); ++v) patch.flat[size_t(v)] = {found(v, 0), found(v, 1)};
}

void flattenRigidly(const Surface& s, Patch& patch, int rounds) {
  std::vector<FlatTriangle> triangles;
  std::vector<Eigen::Triplet<double>> entries{{0, 0, kPin}};
  for (size_t i = 0; i < patch.faces.size(); ++i) {
    triangles.emplace_back(s, patch.faces[i]);
    for (int k = 0; k < 3; ++k)
      addSpring(entries, patch.corners[i][(k + 1) % 3], patch.corners[i][(k + 2) % 3], triangles[i].weight(k));
  }
  const Solver solver(matrixOf(patch.vertices.size(), entries));
  for (int round = 0; round < rounds; ++round) {
    Plane right = Plane::Zero(int(patch.vertices.size()), 2);
    right.row(0) << kPin * patch.flat[0].x, kPin * patch.flat[0].y;
    for (size_t i = 0; i < patch.faces.size(); ++i) {
      double cosine = 0, sine = 0;  // components of the best rotation, times a common factor
      for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double w = triangles[i].weight(k);
        const glm::dvec2 rest = triangles[i].corners[a] - triangles[i].corners[b];
        const glm::dvec2 flat = patch.flat[patch.corners[i][a]] - patch.flat[patch.corners[i][b]];
        cosine += w * glm::dot(rest, flat);
        sine += w * (rest.x * flat.y - rest.y * flat.x);
      }
      const double size = std::hypot(cosine, sine);
      if (size > 0)
        cosine /= size, sine /= size;
      else
        cosine = 1;
      for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double w = triangles[i].weight(k);
        const glm::dvec2 rest = triangles[i].corners[a] - triangles[i].corners[b];
        const double x = w * (cosine * rest.x - sine * rest.y), y = w * (sine * rest.x + cosine * rest.y);
        right(int(patch.corners[i][a]), 0) += x, right(int(patch.corners[i][a]), 1) += y;
        right(int(patch.corners[i][b]), 0) -= x, right(int(patch.corners[i][b]), 1) -= y;
      }
    }
    const Plane found = solver.solve(right);
    for (int v = 0; v < found.rows(); ++v) patch.flat[size_t(v)] = {found(v, 0), found(v, 1)};
  }
}

}  // namespace fourdvt::track
