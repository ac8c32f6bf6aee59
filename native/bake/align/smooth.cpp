// SPDX-License-Identifier: Apache-2.0
#include "bake/align/smooth.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

constexpr double kLength_m = 0.01;               // of smoothing at smoothness 1 and information 1
constexpr double kPull = 1e-3;                   // information of "no displacement"
constexpr double kMinArea = 1e-3;                // of a vertex, in mean areas
constexpr double kMinEdge = 0.05, kMaxEdge = 5;  // cotangent weights of badly shaped faces

double cotangent(const glm::vec3& a, const glm::vec3& b) {
  const double area = glm::length(glm::cross(a, b));
  return area > 0 ? glm::dot(a, b) / area : 0;
}

std::vector<double> vertexAreas(const MeshTopology& topology, std::span<const glm::vec3> base) {
  std::vector<double> areas(topology.vertex_count, 0);
  double sum = 0;
  for (const glm::uvec3& face : topology.face_vertices) {
    const double area = 0.5 * glm::length(glm::cross(base[face.y] - base[face.x], base[face.z] - base[face.x]));
    for (int corner = 0; corner < 3; ++corner) areas[face[corner]] += area / 3;
    sum += area;
  }
  const double mean = sum > 0 ? sum / topology.vertex_count : 1;
  for (double& area : areas) area = std::max(area, kMinArea * mean);
  return areas;
}

void addBlock(uint32_t row, uint32_t column, const glm::dmat2& block, Entries& entries) {
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) entries.emplace_back(2 * row + i, 2 * column + j, block[j][i]);
}

// Rotation that takes components along `from` to components along `to` with the least turn.
glm::dmat2 transport(const glm::mat2x3& from, const glm::mat2x3& to) {
  const glm::mat2 b = glm::transpose(to) * from;
  const glm::dvec2 turn(double(b[0][0]) + b[1][1], double(b[0][1]) - b[1][0]);
  const double length = glm::length(turn);
  const glm::dvec2 unit = length > 0 ? turn / length : glm::dvec2(1, 0);
  return {unit.x, unit.y, -unit.y, unit.x};
}

class Smoother final : public TangentSmoother {
 public:
  Smoother(const MeshTopology& topology, std::span<const glm::vec3> base, const SurfaceFrames& frames,
           double smoothness)
      : areas_(vertexAreas(topology, base)) {
    Entries entries;
    const double scale = smoothness * smoothness * kLength_m * kLength_m;
    for (const glm::uvec3& face : topology.face_vertices)
      for (int corner = 0; corner < 3; ++corner) {
        const uint32_t apex = face[corner], a = face[(corner + 1) % 3], b = face[(corner + 2) % 3];
        if (a == b) continue;
        const double weight =
            0.5 * scale * std::clamp(cotangent(base[a] - base[apex], base[b] - base[apex]), kMinEdge, kMaxEdge);
        const glm::dmat2 b_from_a = transport(frames.tangents[a], frames.tangents[b]);
        addBlock(a, a, glm::dmat2(weight), entries);
        addBlock(b, b, glm::dmat2(weight), entries);
        addBlock(b, a, -weight * b_from_a, entries);
        addBlock(a, b, -weight * glm::transpose(b_from_a), entries);
      }
    for (uint32_t vertex = 0; vertex < topology.vertex_count; ++vertex)  // all four, so that the pattern never changes
      addBlock(vertex, vertex, glm::dmat2(kPull * areas_[vertex], 0, 0, kPull * areas_[vertex]), entries);
    smooth_.resize(2 * topology.vertex_count, 2 * topology.vertex_count);
    smooth_.setFromTriplets(entries.begin(), entries.end());
    solver_.analyzePattern(smooth_);
  }

  std::vector<glm::vec2> solve(const std::vector<VertexEstimate>& estimates) override {
    Matrix matrix = smooth_;
    Eigen::VectorXd right(matrix.rows());
    for (size_t vertex = 0; vertex < estimates.size(); ++vertex)
      for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j)
          matrix.coeffRef(2 * vertex + i, 2 * vertex + j) += areas_[vertex] * estimates[vertex].information[j][i];
        right[2 * vertex + i] = areas_[vertex] * estimates[vertex].pull[i];
      }
    solver_.factorize(matrix);
    const Eigen::VectorXd field = solver_.solve(right);
    std::vector<glm::vec2> displacement(estimates.size());
    for (size_t vertex = 0; vertex < estimates.size(); ++vertex)
      displacement[vertex] = {field[2 * vertex], field[2 * vertex + 1]};
    return displacement;
  }

 private:
  std::vector<double> areas_;
  Matrix smooth_;
  Eigen::SimplicialLDLT<Matrix> solver_;
};

}  // namespace

std::unique_ptr<TangentSmoother> TangentSmoother::create(const MeshTopology& topology, std::span<const glm::vec3> base,
                                                         const SurfaceFrames& frames, double smoothness) {
  return std::make_unique<Smoother>(topology, base, frames, smoothness);
}

}  // namespace fourdvt::bake
