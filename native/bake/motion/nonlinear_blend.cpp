// SPDX-License-Identifier: Apache-2.0
// Blends the faces' deformation gradients, as in deformation transfer, with rotations on the rotation group.
// Rotations are relative to member 0, so that two rigid poses blend exactly for any reference.
#include "bake/motion/nonlinear_blend.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <numbers>
#include <queue>

#include "package/character.h"

namespace fourdvt::bake {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kThinnest =
    1e-3;  // twice a face's area over the square of its longest edge; below, it has no gradient
constexpr double kNearPi = 0.75 * std::numbers::pi;
constexpr double kSteady = 0.2;  // radians of deviation between members beyond which a face's anchor weight falls

Vector3d toEigen(const glm::vec3& v) { return {v.x, v.y, v.z}; }

struct Face {
  glm::uvec3 vertices{0};
  std::array<double, 3> half_cotangents{};  // [i] of the edge from corner i to the next
  std::array<Vector3d, 3> edges;            // [i] the same edge in the reference pose
  Matrix3d inverse;                         // inverse of the reference pose's edge frame
  bool has_gradient = false;                // otherwise its edges follow the linear blend
  int parent = -1;  // the neighbour visited before it, which determines the branch of the logarithm
};

// Two edges and a normal of about their length. Sets `ok` to false if the face has no usable area.
Matrix3d edgeFrame(const Vector3d& a, const Vector3d& b, const Vector3d& c, bool& ok) {
  Matrix3d frame;
  frame.col(0) = b - a;
  frame.col(1) = c - a;
  const Vector3d normal = frame.col(0).cross(frame.col(1));
  const double area = normal.norm();
  const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
  ok = area > kThinnest * longest && longest > 0;
  frame.col(2) = area > 0 ? Vector3d(normal / std::sqrt(area)) : Vector3d::Zero();
  return frame;
}

// Rotation of the polar decomposition, by Newton's iteration, or by singular values where that fails.
Matrix3d rotationOf(const Matrix3d& gradient) {
  Matrix3d rotation = gradient;
  for (int i = 0; i < 20; ++i) {
    const double determinant = rotation.determinant();
    if (!(determinant > 1e-9 * std::pow(rotation.norm(), 3))) break;
    const Matrix3d inverse_transpose = rotation.inverse().transpose();
    const double scale = std::sqrt(inverse_transpose.norm() / rotation.norm());
    const Matrix3d next = 0.5 * (scale * rotation + inverse_transpose / scale);
    if ((next - rotation).squaredNorm() < 1e-20) return next;
    rotation = next;
  }
  const Eigen::JacobiSVD<Matrix3d> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

Vector3d logOf(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Matrix3d expOf(const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 1e-12 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Matrix3d::Identity();
}

// Selects the logarithm's branch near a half turn, where the shorter rotation is unstable: the one nearest to the
// neighbour's.
Vector3d likeNeighbour(const Vector3d& turn, const Vector3d& neighbour) {
  const double angle = turn.norm();
  if (angle < kNearPi) return turn;
  const Vector3d other = turn * (1 - 2 * std::numbers::pi / angle);
  return (other - neighbour).squaredNorm() < (turn - neighbour).squaredNorm() ? other : turn;
}

}  // namespace

class NonlinearBlend::Solver {
 public:
  Status prepare(const MeshTopology& topology, const Positions& reference) {
    vertex_count_ = topology.vertex_count;
    makeFaces(topology, reference);
    if (std::none_of(faces_.begin(), faces_.end(), [](const Face& f) { return f.has_gradient; }))
      return Error{ErrorId::MeshTopology, "mesh: no face has an area; check the capture's units and positions"};
    orderFaces();
    findParts();
    return factorise();
  }

  Positions blend(std::span<const Positions> members, std::span<const float> weights) const {
    const Positions linear = linearBlend(members, weights);
    std::vector<size_t> used;
    for (size_t m = 0; m < weights.size(); ++m)
      if (weights[m] != 0) used.push_back(m);
    if (used.size() < 2) return linear;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(vertex_count_, 3);
    std::vector<Turns> turns(faces_.size());  // [face][used member] rotation from the first used member
    const Blending blending{members, weights, used, linear};
    for (size_t f : order_) addFace(f, blending, turns, right);
    for (size_t p = 0; p < anchors_.size(); ++p) right.row(anchors_[p]) += toEigen(linear[anchors_[p]]).transpose();
    return placed(solver_.solve(right), linear, steadiness(weights, used, turns));
  }

 private:
  using Turns = std::array<Vector3d, package::kMaxMembers>;

  // Arguments of one call of blend().
  struct Blending {
    std::span<const Positions> members;
    std::span<const float> weights;
    const std::vector<size_t>& used;  // members whose weight is not 0
    const Positions& linear;          // their linear blend
  };

  void makeFaces(const MeshTopology& topology, const Positions& reference) {
    for (const glm::uvec3& vertices : topology.face_vertices) {
      Face face;
      face.vertices = vertices;
      std::array<Vector3d, 3> corners;
      for (int i = 0; i < 3; ++i) corners[i] = toEigen(reference[vertices[i]]);
      const Matrix3d frame = edgeFrame(corners[0], corners[1], corners[2], face.has_gradient);
      for (int i = 0; i < 3; ++i) {
        face.edges[i] = corners[(i + 1) % 3] - corners[i];
        const Vector3d a = corners[i] - corners[(i + 2) % 3], b = corners[(i + 1) % 3] - corners[(i + 2) % 3];
        face.half_cotangents[i] = face.has_gradient ? 0.5 * a.dot(b) / a.cross(b).norm() : 0.5;
      }
      if (face.has_gradient) face.inverse = frame.inverse();
      faces_.push_back(face);
    }
  }

  // Visits faces breadth first over shared vertices; degenerate faces are never parents.
  void orderFaces() {
    std::vector<std::vector<uint32_t>> around(vertex_count_);
    for (uint32_t f = 0; f < faces_.size(); ++f)
      for (int i = 0; i < 3; ++i) around[faces_[f].vertices[i]].push_back(f);
    std::vector<bool> seen(faces_.size(), false);
    for (uint32_t start = 0; start < faces_.size(); ++start) {
      if (seen[start]) continue;
      std::queue<uint32_t> next({start});
      seen[start] = true;
      while (!next.empty()) {
        const uint32_t f = next.front();
        next.pop();
        order_.push_back(f);
        if (!faces_[f].has_gradient) continue;
        for (int i = 0; i < 3; ++i) {
          for (uint32_t g : around[faces_[f].vertices[i]]) {
            if (seen[g]) continue;
            seen[g] = true;
            faces_[g].parent = int(f);
            next.push(g);
          }
        }
      }
    }
  }

  // Finds the connected parts, each of which is anchored and placed by itself. A vertex without faces is a part.
  void findParts() {
    std::vector<uint32_t> root(vertex_count_);
    for (uint32_t v = 0; v < vertex_count_; ++v) root[v] = v;
    const auto find = [&](uint32_t v) {
      while (root[v] != v) v = root[v] = root[root[v]];
      return v;
    };
    for (const Face& face : faces_) {
      root[find(face.vertices.y)] = find(face.vertices.x);
      root[find(face.vertices.z)] = find(face.vertices.x);
    }
    part_of_.resize(vertex_count_);
    std::vector<int> part_of_root(vertex_count_, -1);
    for (uint32_t v = 0; v < vertex_count_; ++v) {
      int& part = part_of_root[find(v)];
      if (part < 0) {
        part = int(anchors_.size());
        anchors_.push_back(v);
      }
      part_of_[v] = part;
    }
  }

  Status factorise() {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Face& face : faces_) {
      for (int i = 0; i < 3; ++i) {
        const int a = int(face.vertices[i]), b = int(face.vertices[(i + 1) % 3]);
        const double c = face.half_cotangents[i];
        entries.insert(entries.end(), {{a, a, c}, {b, b, c}, {a, b, -c}, {b, a, -c}});
      }
    }
    for (uint32_t anchor : anchors_) entries.emplace_back(int(anchor), int(anchor), 1.0);
    Eigen::SparseMatrix<double> laplacian(vertex_count_, vertex_count_);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(laplacian);
    if (solver_.info() != Eigen::Success)
      return Error{ErrorId::MeshTopology, "mesh: its faces do not make a solvable surface; check the positions"};
    return {};
  }

  // Adds the face's blended edges to the right-hand side. turns: of the faces before it in order_; sets its own.
  void addFace(size_t index, const Blending& blending, std::vector<Turns>& turns, Eigen::MatrixX3d& right) const {
    const Face& face = faces_[index];
    Matrix3d gradient = Matrix3d::Zero();
    if (face.has_gradient) gradient = blendedGradient(face, blending, turns, turns[index]);
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = face.vertices[i], b = face.vertices[(i + 1) % 3];
      const Vector3d edge =
          face.has_gradient ? Vector3d(gradient * face.edges[i]) : toEigen(blending.linear[b] - blending.linear[a]);
      right.row(b) += face.half_cotangents[i] * edge.transpose();
      right.row(a) -= face.half_cotangents[i] * edge.transpose();
    }
  }

  Matrix3d blendedGradient(const Face& face, const Blending& blending, const std::vector<Turns>& turns,
                           Turns& own) const {
    const std::vector<size_t>& used = blending.used;
    Matrix3d base = Matrix3d::Identity(), stretch = Matrix3d::Zero();
    Vector3d turn = Vector3d::Zero();
    for (size_t k = 0; k < used.size(); ++k) {
      const Positions& p = blending.members[used[k]];
      bool ok = false;
      const Matrix3d gradient =
          edgeFrame(toEigen(p[face.vertices.x]), toEigen(p[face.vertices.y]), toEigen(p[face.vertices.z]), ok) *
          face.inverse;
      const Matrix3d rotation = rotationOf(gradient);
      const double w = blending.weights[used[k]];
      stretch += w * (rotation.transpose() * gradient);
      if (k == 0) {
        base = rotation;
        continue;
      }
      own[k] = logOf(base.transpose() * rotation);
      if (face.parent >= 0) own[k] = likeNeighbour(own[k], turns[size_t(face.parent)][k]);
      turn += w * own[k];
    }
    return base * expOf(turn) * stretch;
  }

  // Anchor weight per vertex; falls with the rotation of its faces between the members, because the linear blend is
  // exact without rotation. If all faces rotate alike, the weights are equal.
  std::vector<double> steadiness(std::span<const float> weights, const std::vector<size_t>& used,
                                 const std::vector<Turns>& turns) const {
    double pairs = 0;
    for (size_t m : used) pairs += weights[m] * (1 - weights[m]);
    std::vector<double> steady(vertex_count_, 1e-12);
    for (size_t f = 0; f < faces_.size(); ++f) {
      if (!faces_[f].has_gradient) continue;
      Vector3d mean = Vector3d::Zero();
      double square = 0;
      for (size_t k = 1; k < used.size(); ++k) {
        mean += double(weights[used[k]]) * turns[f][k];
        square += double(weights[used[k]]) * turns[f][k].squaredNorm();
      }
      const double apart = (square - mean.squaredNorm()) /
                           pairs;  // variance of the rotation; for two members half of the squared angle between them
      const double say = 1 / std::pow(1 + apart / (kSteady * kSteady), 2);
      for (int i = 0; i < 3; ++i) steady[faces_[f].vertices[i]] += say;
    }
    return steady;
  }

  // Moves every connected part to its place in the linear blend, by the weighted mean offset of its vertices.
  Positions placed(const Eigen::MatrixX3d& solved, const Positions& linear, const std::vector<double>& steady) const {
    std::vector<Vector3d> shift(anchors_.size(), Vector3d::Zero());
    std::vector<double> weight(anchors_.size(), 0);
    for (uint32_t v = 0; v < vertex_count_; ++v) {
      shift[part_of_[v]] += steady[v] * (toEigen(linear[v]) - solved.row(v).transpose());
      weight[part_of_[v]] += steady[v];
    }
    Positions out(vertex_count_);
    for (uint32_t v = 0; v < vertex_count_; ++v) {
      const Vector3d p = solved.row(v).transpose() + shift[part_of_[v]] / weight[part_of_[v]];
      out[v] = {float(p.x()), float(p.y()), float(p.z())};
    }
    return out;
  }

  uint32_t vertex_count_ = 0;
  std::vector<Face> faces_;
  std::vector<uint32_t> order_;    // faces, parents first
  std::vector<uint32_t> anchors_;  // [part] vertex
  std::vector<int> part_of_;       // [vertex]
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

Result<NonlinearBlend> NonlinearBlend::create(const MeshTopology& topology, const Positions& reference) {
  if (reference.size() != topology.vertex_count)
    return Error{ErrorId::MeshTopology, "mesh: the reference pose has another number of vertices"};
  auto solver = std::make_shared<Solver>();
  FOURDVT_TRY(solver->prepare(topology, reference));
  return NonlinearBlend(std::move(solver));
}

Positions NonlinearBlend::blend(std::span<const Positions> members, std::span<const float> weights) const {
  return solver_->blend(members, weights);
}

Positions linearBlend(std::span<const Positions> members, std::span<const float> weights) {
  Positions out(members[0].size(), glm::vec3(0));
  for (size_t m = 0; m < members.size() && m < weights.size(); ++m) {
    if (weights[m] == 0) continue;
    for (size_t v = 0; v < out.size(); ++v) out[v] += weights[m] * members[m][v];
  }
  return out;
}

}  // namespace fourdvt::bake
