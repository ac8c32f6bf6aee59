// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/actors/body.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lab/studio/actors/atlas.h"

namespace fourdvt::studio {
namespace {

constexpr double kJoin_m = 0.012;    // radius by which the joints of limbs are rounded
constexpr double kLeftOut_m = 1e-6;  // grid value that counts as outside
constexpr double kSoften_m = 0.016;  // width of the skin's transition between bones
constexpr glm::dvec3 kBodyMin{-0.80, -0.06, -0.30}, kBodyMax{0.80, 1.88, 0.38};

struct RoundedCone {
  Bone bone;
  glm::dvec3 a, b;
  double radius_a, radius_b;
};

glm::dvec3 mirrored(const glm::dvec3& p) { return {-p.x, p.y, p.z}; }

const std::vector<RoundedCone>& cones() {
  static const std::vector<RoundedCone> all = [] {
    std::vector<RoundedCone> list{{Pelvis, {-0.07, 0.95, 0}, {0.07, 0.95, 0}, 0.115, 0.115},
                                  {Spine, {0, 1.04, 0}, {0, 1.20, 0.005}, 0.125, 0.125},
                                  {Chest, {-0.10, 1.33, 0}, {0.10, 1.33, 0}, 0.115, 0.115},
                                  {Head, {0, 1.42, 0}, {0, 1.53, 0.01}, 0.056, 0.056},
                                  {Head, {0, 1.60, 0.015}, {0, 1.68, 0.01}, 0.095, 0.098}};
    const RoundedCone left[] = {{UpperArmL, kShoulderRest, kElbowRest, 0.056, 0.047},
                                {ForearmL, kElbowRest, kWristRest, 0.046, 0.035},
                                {HandL, kWristRest, {0.65, 0.93, 0.035}, 0.037, 0.032},
                                {ThighL, kHipRest, kKneeRest, 0.085, 0.060},
                                {ShinL, kKneeRest, kAnkleRest, 0.058, 0.044},
                                {FootL, {0.15, 0.045, -0.03}, {0.165, 0.04, 0.15}, 0.045, 0.040}};
    for (const RoundedCone& cone : left) {
      list.push_back(cone);
      list.push_back(
          {static_cast<Bone>(cone.bone + 3), mirrored(cone.a), mirrored(cone.b), cone.radius_a, cone.radius_b});
    }
    return list;
  }();
  return all;
}

// Distance to a capsule whose radius changes along its axis; its gradient's length stays near 1 if it is slender.
double distanceTo(const RoundedCone& cone, const glm::dvec3& p) {
  const glm::dvec3 axis = cone.b - cone.a;
  const double t = std::clamp(glm::dot(p - cone.a, axis) / glm::dot(axis, axis), 0.0, 1.0);
  return glm::length(p - cone.a - t * axis) - glm::mix(cone.radius_a, cone.radius_b, t);
}

glm::dvec3 bodyGradient(const glm::dvec3& p) {
  constexpr double h = 1e-5;
  glm::dvec3 g;
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 d(0);
    d[k] = h;
    g[k] = (bodyDistance(p + d) - bodyDistance(p - d)) / (2 * h);
  }
  return g;
}

glm::dvec3 onBody(glm::dvec3 p) {
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 g = bodyGradient(p);
    p -= bodyDistance(p) / std::max(glm::dot(g, g), 0.05) * g;
  }
  return p;
}

// Surface nets: a vertex in each cell crossed by the surface, and a quad across each grid edge that it cuts.
class SurfaceNets {
 public:
  explicit SurfaceNets(double cell_m) : cell_(cell_m), size_(glm::ivec3((kBodyMax - kBodyMin) / cell_m) + 2) {}

  RestMesh run() {
    values_.resize(size_t(size_.x) * size_.y * size_.z);
    forEach(size_, [&](const glm::ivec3& i) { values_[index(i)] = bodyDistance(point(i)); });
    while (!settle()) {
    }
    forEach(size_ - 1, [&](const glm::ivec3& i) { addVertex(i); });
    for (int axis = 0; axis < 3; ++axis) forEach(size_ - 1, [&](const glm::ivec3& i) { addQuad(i, axis); });
    triangulate();
    mesh_.topology.vertex_count = static_cast<uint32_t>(mesh_.positions.size());
    return std::move(mesh_);
  }

 private:
  template <class F>
  static void forEach(const glm::ivec3& end, F visit) {
    for (int z = 0; z < end.z; ++z)
      for (int y = 0; y < end.y; ++y)
        for (int x = 0; x < end.x; ++x) visit({x, y, z});
  }
  size_t index(const glm::ivec3& i) const { return (size_t(i.z) * size_.y + i.y) * size_.x + i.x; }
  glm::dvec3 point(const glm::ivec3& i) const { return kBodyMin + cell_ * glm::dvec3(i); }

  void addVertex(const glm::ivec3& cell) {
    glm::dvec3 sum(0);
    int cuts = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 4; ++side) {
        glm::ivec3 a = cell;
        a[(axis + 1) % 3] += side & 1;
        a[(axis + 2) % 3] += side >> 1;
        glm::ivec3 b = a;
        ++b[axis];
        const double va = values_[index(a)], vb = values_[index(b)];
        if ((va < 0) == (vb < 0)) continue;
        sum += glm::mix(point(a), point(b), va / (va - vb));
        ++cuts;
      }
    if (cuts == 0) return;
    vertices_[index(cell)] = static_cast<uint32_t>(mesh_.positions.size());
    mesh_.positions.emplace_back(onBody(sum / double(cuts)));
  }

  void addQuad(const glm::ivec3& a, int axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (a[u] == 0 || a[v] == 0) return;
    glm::ivec3 b = a;
    ++b[axis];
    const bool inside = values_[index(a)] < 0;
    if (inside == (values_[index(b)] < 0)) return;
    uint32_t q[4];
    for (int k = 0; k < 4; ++k) {
      glm::ivec3 cell = a;
      if (k == 0 || k == 3) --cell[u];
      if (k < 2) --cell[v];
      q[k] = vertices_.at(index(cell));
    }
    if (!inside) std::swap(q[1], q[3]);
    quads_.push_back({q[0], q[1], q[2], q[3]});
  }

  // Splits the quad along its shorter diagonal.
  void triangulate() {
    const auto& p = mesh_.positions;
    for (const auto& q : quads_) {
      const int s = glm::distance(p[q[0]], p[q[2]]) <= glm::distance(p[q[1]], p[q[3]]) ? 0 : 1;
      mesh_.topology.face_vertices.emplace_back(q[s], q[s + 1], q[s + 2]);
      mesh_.topology.face_vertices.emplace_back(q[s], q[s + 2], q[(s + 3) % 4]);
    }
  }

  // Removes the shallower corner of a grid square with two opposite corners inside, which would yield an edge with four
  // faces. Returns false if a corner was removed.
  bool settle() {
    bool settled = true;
    for (int axis = 0; axis < 3; ++axis)
      forEach(size_ - 1, [&](const glm::ivec3& i) {
        glm::ivec3 u(0), v(0);
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
        double* corner[] = {&values_[index(i)], &values_[index(i + u)], &values_[index(i + u + v)],
                            &values_[index(i + v)]};
        for (int k = 0; k < 2; ++k) {
          const bool inside = *corner[k] < 0 && *corner[k + 2] < 0;
          if (!inside || *corner[1 - k] < 0 || *corner[3 - k] < 0) continue;
          *(*corner[k] > *corner[k + 2] ? corner[k] : corner[k + 2]) = kLeftOut_m;
          settled = false;
        }
      });
    return settled;
  }

  const double cell_;
  const glm::ivec3 size_;
  std::vector<double> values_;
  std::map<size_t, uint32_t> vertices_;  // by cell
  std::vector<std::array<uint32_t, 4>> quads_;
  RestMesh mesh_;
};

}  // namespace

double bodyDistance(const glm::dvec3& p) {
  double nearest = 1e9, sum = 0;
  for (const RoundedCone& cone : cones()) nearest = std::min(nearest, distanceTo(cone, p));
  for (const RoundedCone& cone : cones()) sum += std::exp((nearest - distanceTo(cone, p)) / kJoin_m);
  return nearest - kJoin_m * std::log(sum);
}

std::array<float, kBoneCount> boneWeights(const glm::dvec3& p) {
  std::array<double, kBoneCount> distance;
  distance.fill(1e9);
  for (const RoundedCone& cone : cones()) distance[cone.bone] = std::min(distance[cone.bone], distanceTo(cone, p));
  const double nearest = *std::min_element(distance.begin(), distance.end());
  double sum = 0;
  for (double& d : distance) sum += d = std::exp((nearest - d) / kSoften_m);
  std::array<float, kBoneCount> weights;
  for (int b = 0; b < kBoneCount; ++b) weights[b] = static_cast<float>(distance[b] / sum);
  return weights;
}

Bone boneAt(const glm::dvec3& p) {
  const auto weights = boneWeights(p);
  return static_cast<Bone>(std::max_element(weights.begin(), weights.end()) - weights.begin());
}

RestMesh meshBody(double cell_m) {
  RestMesh mesh = SurfaceNets(cell_m).run();
  unwrap(mesh, [](const glm::vec3& p) { return boneAt(p); });
  return mesh;
}

RestMesh subdivideOnBody(const RestMesh& mesh) {
  RestMesh out;
  out.positions = mesh.positions;
  out.topology.uvs = mesh.topology.uvs;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> vertices, uvs;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto [it, fresh] = vertices.try_emplace(std::minmax(a, b), uint32_t(out.positions.size()));
    if (fresh)
      out.positions.emplace_back(onBody(0.5 * (glm::dvec3(mesh.positions[a]) + glm::dvec3(mesh.positions[b]))));
    return it->second;
  };
  const auto uvMiddle = [&](uint32_t a, uint32_t b) {
    const auto [it, fresh] = uvs.try_emplace(std::minmax(a, b), uint32_t(out.topology.uvs.size()));
    if (fresh) out.topology.uvs.push_back(0.5f * (mesh.topology.uvs[a] + mesh.topology.uvs[b]));
    return it->second;
  };
  const auto split = [](const glm::uvec3& f, const auto& between, std::vector<glm::uvec3>& faces) {
    const glm::uvec3 m(between(f.x, f.y), between(f.y, f.z), between(f.z, f.x));
    faces.insert(faces.end(), {{f.x, m.x, m.z}, {m.x, f.y, m.y}, {m.z, m.y, f.z}, m});
  };
  for (const glm::uvec3& f : mesh.topology.face_vertices) split(f, middle, out.topology.face_vertices);
  for (const glm::uvec3& f : mesh.topology.face_uvs) split(f, uvMiddle, out.topology.face_uvs);
  out.topology.vertex_count = static_cast<uint32_t>(out.positions.size());
  return out;
}

}  // namespace fourdvt::studio
