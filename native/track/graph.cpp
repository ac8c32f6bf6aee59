// SPDX-License-Identifier: Apache-2.0
#include "track/graph.h"

#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

namespace fourdvt::track {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Eigen::Matrix3d, Eigen::Vector3d;

struct Neighbour {
  uint32_t vertex = 0;
  float length_m = 0;
};
using Neighbours = std::vector<std::vector<Neighbour>>;

Neighbours neighboursOf(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions) {
  Neighbours out(positions.size());
  for (const glm::uvec2& e : edgesOf(faces)) {
    const float length = glm::distance(positions[e.x], positions[e.y]);
    out[e.x].push_back({e.y, length});
    out[e.y].push_back({e.x, length});
  }
  return out;
}

// Lowers distances along edges to those from `from`, where they are smaller and below `limit_m`; calls `reached`.
template <class Reached>
void spread(const Neighbours& neighbours, uint32_t from, float limit_m, std::vector<float>& distances,
            const Reached& reached) {
  using Entry = std::pair<float, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  distances[from] = 0;
  open.push({0.f, from});
  while (!open.empty()) {
    const auto [distance, vertex] = open.top();
    open.pop();
    if (distance > distances[vertex]) continue;
    reached(vertex, distance);
    for (const Neighbour& n : neighbours[vertex]) {
      const float next = distance + n.length_m;
      if (next >= distances[n.vertex] || next > limit_m) continue;
      distances[n.vertex] = next;
      open.push({next, n.vertex});
    }
  }
}

constexpr float kFar = std::numeric_limits<float>::infinity();

Matrix3d eigen(const glm::dmat3& m) {
  Matrix3d out;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) out(r, c) = m[c][r];
  return out;
}
Vector3d eigen(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Matrix3d cross(const glm::dvec3& v) {
  Matrix3d out;
  out << 0, -v.z, v.y, v.z, 0, -v.x, -v.y, v.x, 0;
  return out;
}

glm::dmat3 rotationOf(const Vector3d& turn) {
  const double angle = turn.norm();
  const Matrix3d m = angle < 1e-12 ? Matrix3d::Identity() : Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  glm::dmat3 out;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) out[c][r] = m(r, c);
  return out;
}

// Normal equations of all nodes, six unknowns each: rotation about the node, then shift.
class NodeSystem {
 public:
  explicit NodeSystem(size_t nodes) : right_(Eigen::VectorXd::Zero(6 * Eigen::Index(nodes))) {}

  void add(uint32_t a, uint32_t b, const Matrix6& block) {
    if (a > b) return;  // lower triangle alone
    blocks_.try_emplace({b, a}, Matrix6::Zero()).first->second += block.transpose();
  }
  void add(uint32_t a, const Vector6& right) { right_.segment<6>(6 * Eigen::Index(a)) += right; }

  Eigen::VectorXd solve(double damping) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(blocks_.size() * 36);
    for (const auto& [at, block] : blocks_)
      for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c)
          if (at.first != at.second || r >= c)
            entries.emplace_back(int(6 * at.first) + r, int(6 * at.second) + c,
                                 block(r, c) + (at.first == at.second && r == c ? damping * (1 + block(r, r)) : 0));
    Eigen::SparseMatrix<double> matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    return solver.solve(right_);
  }

 private:
  std::map<std::pair<uint32_t, uint32_t>, Matrix6> blocks_;  // (row, column), row >= column
  Eigen::VectorXd right_;
};

void addData(const DeformationGraph& graph, std::span<const glm::vec3> node_positions, std::span<const glm::vec3> rest,
             std::span<const Pull> pulls, const GraphPose& pose, NodeSystem& system) {
  for (size_t v = 0; v < pulls.size(); ++v) {
    const Matrix3d a = eigen(pulls[v].matrix);
    if (a.trace() <= 0) continue;
    const Vector3d b = eigen(pulls[v].vector);
    Eigen::Matrix<double, 3, 6> jacobians[DeformationGraph::kInfluences];
    for (int i = 0; i < DeformationGraph::kInfluences; ++i) {
      const auto& [node, weight] = graph.influences[v][i];
      const glm::dvec3 arm = pose.rotations[node] * (glm::dvec3(rest[v]) - glm::dvec3(node_positions[node]));
      jacobians[i].leftCols<3>() = -weight * cross(arm);
      jacobians[i].rightCols<3>() = weight * Matrix3d::Identity();
    }
    for (int i = 0; i < DeformationGraph::kInfluences; ++i) {
      const auto& [node, weight] = graph.influences[v][i];
      if (weight <= 0) continue;
      const Eigen::Matrix<double, 6, 3> left = jacobians[i].transpose() * a;
      system.add(node, Vector6(jacobians[i].transpose() * b));
      for (int k = 0; k < DeformationGraph::kInfluences; ++k)
        if (graph.influences[v][k].weight > 0)
          system.add(node, graph.influences[v][k].node, Matrix6(left * jacobians[k]));
    }
  }
}

void addRigidity(const DeformationGraph& graph, std::span<const glm::vec3> node_positions, double weight,
                 const GraphPose& pose, NodeSystem& system) {
  for (const auto& [from, to] : graph.links) {
    const glm::dvec3 between = glm::dvec3(node_positions[to]) - glm::dvec3(node_positions[from]);
    const glm::dvec3 arm = pose.rotations[from] * between;
    // r = arm + shift_from − between − shift_to
    const Vector3d residual = eigen(arm + pose.shifts[from] - between - pose.shifts[to]);
    Eigen::Matrix<double, 3, 6> at_from = Eigen::Matrix<double, 3, 6>::Zero(), at_to = at_from;
    at_from.leftCols<3>() = -cross(arm);
    at_from.rightCols<3>() = Matrix3d::Identity();
    at_to.rightCols<3>() = -Matrix3d::Identity();
    system.add(from, from, Matrix6(weight * at_from.transpose() * at_from));
    system.add(to, to, Matrix6(weight * at_to.transpose() * at_to));
    system.add(from, to, Matrix6(weight * at_from.transpose() * at_to));
    system.add(to, from, Matrix6(weight * at_to.transpose() * at_from));
    system.add(from, Vector6(-weight * at_from.transpose() * residual));
    system.add(to, Vector6(-weight * at_to.transpose() * residual));
  }
}

}  // namespace

std::vector<glm::uvec2> edgesOf(std::span<const glm::uvec3> faces) {
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  for (const glm::uvec3& f : faces)
    for (int k = 0; k < 3; ++k) pairs.push_back(std::minmax(f[k], f[(k + 1) % 3]));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<glm::uvec2> edges;
  for (const auto& [a, b] : pairs) edges.emplace_back(a, b);
  return edges;
}

DeformationGraph makeGraph(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                           uint32_t node_count) {
  const Neighbours neighbours = neighboursOf(faces, positions);
  DeformationGraph graph;
  std::vector<float> nearest(positions.size(), kFar);
  uint32_t next = 0;
  while (graph.nodes.size() < std::min<size_t>(node_count, positions.size())) {
    graph.nodes.push_back(next);
    spread(neighbours, next, kFar, nearest, [](uint32_t, float) {});
    next = uint32_t(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  const float reach = 4 * *std::max_element(nearest.begin(), nearest.end()) + 1e-6f;
  using Candidate = std::pair<float, uint32_t>;
  std::vector<std::vector<Candidate>> candidates(positions.size());
  std::vector<float> distances(positions.size());
  for (uint32_t node = 0; node < graph.nodes.size(); ++node) {
    std::fill(distances.begin(), distances.end(), kFar);
    spread(neighbours, graph.nodes[node], reach, distances, [&](uint32_t vertex, float distance) {
      candidates[vertex].push_back({distance, node});
    });
  }
  std::vector<std::pair<uint32_t, uint32_t>> links;
  for (size_t v = 0; v < positions.size(); ++v) {
    auto& near = candidates[v];
    std::sort(near.begin(), near.end());
    auto& influences = graph.influences.emplace_back();
    const size_t used = std::min<size_t>(DeformationGraph::kInfluences, near.size());
    // The first candidate beyond the used ones bounds their support.
    const double bound = near.size() > used ? near[used].first : 1.2 * near[used - 1].first + 1e-6;
    double sum = 0;
    for (size_t i = 0; i < used; ++i) {
      const double share = std::max(0.0, 1 - near[i].first / bound);
      influences[i] = {near[i].second, share * share + 1e-9};
      sum += influences[i].weight;
    }
    for (size_t i = 0; i < used; ++i) influences[i].weight /= sum;
    for (size_t i = 0; i < used; ++i)
      for (size_t k = 0; k < used; ++k)
        if (i != k) links.push_back({influences[i].node, influences[k].node});
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  for (const auto& [from, to] : links) graph.links.push_back({from, to});
  return graph;
}

GraphPose GraphPose::identity(size_t nodes) {
  return {std::vector<glm::dmat3>(nodes, glm::dmat3(1.0)), std::vector<glm::dvec3>(nodes, glm::dvec3(0))};
}

Positions deformed(const DeformationGraph& graph, std::span<const glm::vec3> node_positions,
                   std::span<const glm::vec3> rest, const GraphPose& pose) {
  Positions out;
  out.reserve(rest.size());
  for (size_t v = 0; v < rest.size(); ++v) {
    glm::dvec3 sum(0);
    for (const auto& [node, weight] : graph.influences[v]) {
      if (weight <= 0) continue;
      const glm::dvec3 g = node_positions[node];
      sum += weight * (pose.rotations[node] * (glm::dvec3(rest[v]) - g) + g + pose.shifts[node]);
    }
    out.emplace_back(sum);
  }
  return out;
}

std::vector<glm::dmat3> vertexRotations(const DeformationGraph& graph, const GraphPose& pose) {
  std::vector<glm::dmat3> out;
  out.reserve(graph.influences.size());
  for (const auto& influences : graph.influences) {
    glm::dmat3 blend(0.0);
    for (const auto& [node, weight] : influences)
      if (weight > 0) blend += weight * pose.rotations[node];
    // Gram-Schmidt: the blended rotations are close to each other.
    const glm::dvec3 x = glm::normalize(blend[0]), y = glm::normalize(blend[1] - glm::dot(blend[1], x) * x);
    out.emplace_back(x, y, glm::cross(x, y));
  }
  return out;
}

void Pull::add(const glm::dvec3& direction, double residual, double weight) {
  matrix += weight * glm::outerProduct(direction, direction);
  vector += weight * residual * direction;
}

double fitGraph(const DeformationGraph& graph, std::span<const glm::vec3> node_positions,
                std::span<const glm::vec3> rest, std::span<const Pull> pulls, const GraphWeights& weights,
                GraphPose& pose) {
  NodeSystem system(graph.nodes.size());
  addData(graph, node_positions, rest, pulls, pose, system);
  addRigidity(graph, node_positions, weights.rigidity, pose, system);
  const Eigen::VectorXd step = system.solve(weights.damping);
  double largest = 0;
  for (size_t j = 0; j < graph.nodes.size(); ++j) {
    const Vector3d turn = step.segment<3>(6 * Eigen::Index(j)), shift = step.segment<3>(6 * Eigen::Index(j) + 3);
    pose.rotations[j] = rotationOf(turn) * pose.rotations[j];
    pose.shifts[j] += glm::dvec3(shift.x(), shift.y(), shift.z());
    largest = std::max(largest, shift.norm());
  }
  return largest;
}

std::vector<glm::dvec3> fitVertices(std::span<const glm::uvec2> edges, std::span<const Pull> pulls,
                                    const VertexWeights& weights) {
  const auto count = int(pulls.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(pulls.size() * 6 + edges.size() * 9);
  Eigen::VectorXd right(3 * count);
  for (int v = 0; v < count; ++v) {
    const Pull& pull = pulls[size_t(v)];
    for (int r = 0; r < 3; ++r) {
      right(3 * v + r) = pull.vector[r];
      for (int c = 0; c <= r; ++c)
        entries.emplace_back(3 * v + r, 3 * v + c, pull.matrix[c][r] + (r == c ? weights.keep + 1e-9 : 0));
    }
  }
  for (const glm::uvec2& e : edges) {
    const auto low = int(std::min(e.x, e.y)), high = int(std::max(e.x, e.y));
    for (int r = 0; r < 3; ++r) {
      entries.emplace_back(3 * low + r, 3 * low + r, weights.stiffness);
      entries.emplace_back(3 * high + r, 3 * high + r, weights.stiffness);
      entries.emplace_back(3 * high + r, 3 * low + r, -weights.stiffness);
    }
  }
  Eigen::SparseMatrix<double> matrix(3 * count, 3 * count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd solved = solver.solve(right);
  std::vector<glm::dvec3> out;
  for (int v = 0; v < count; ++v) out.emplace_back(solved(3 * v), solved(3 * v + 1), solved(3 * v + 2));
  return out;
}

}  // namespace fourdvt::track
