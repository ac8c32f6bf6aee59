// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/genus_zero.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <queue>
#include <tuple>

#include "base/parallel.h"
#include "track/mesh/nearest.h"
#include "track/mesh/voxel_grid.h"

namespace fourdvt::track {
namespace {

constexpr int kMargin = 3;          // voxels around the surface
constexpr float kBand = 3;          // voxels; distances are clamped to ± this
constexpr float kMinDepth = 0.05f;  // voxels; least distance of a voxel from the surface that is drawn

// Winding numbers along one axis: 1 where the surface encloses a voxel. Surfaces with holes have wrong columns.
void addVotes(const TriangleMesh& surface, int axis, const VoxelGrid& grid, std::vector<uint8_t>& votes) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  struct Crossing {
    double depth;
    int sign;
  };
  std::vector<std::vector<Crossing>> columns(size_t(grid.size[u]) * size_t(grid.size[v]));
  for (const glm::uvec3& face : surface.faces) {
    glm::dvec3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = grid.inGrid(surface.positions[face[k]]);
    const glm::dvec2 a(corners[0][u], corners[0][v]), b(corners[1][u], corners[1][v]), c(corners[2][u], corners[2][v]);
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0) continue;
    const glm::dvec2 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    for (int y = std::max(0, int(std::ceil(low.y))); y <= std::min(grid.size[v] - 1, int(std::floor(high.y))); ++y)
      for (int x = std::max(0, int(std::ceil(low.x))); x <= std::min(grid.size[u] - 1, int(std::floor(high.x))); ++x) {
        const auto share = [&](const glm::dvec2& p, const glm::dvec2& q) {
          return ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) / area;
        };
        const double wa = share(b, c), wb = share(c, a), wc = share(a, b);
        if (wa < 0 || wb < 0 || wc < 0) continue;
        const double depth = wa * corners[0][axis] + wb * corners[1][axis] + wc * corners[2][axis];
        columns[size_t(y) * size_t(grid.size[u]) + size_t(x)].push_back({depth, area < 0 ? 1 : -1});
      }
  }
  inParallel(columns.size(), [&](size_t i) {
    auto& column = columns[i];
    std::sort(column.begin(), column.end(), [](const Crossing& a, const Crossing& b) {
      return std::tie(a.depth, a.sign) < std::tie(b.depth, b.sign);
    });
    glm::ivec3 at;
    at[u] = int(i) % grid.size[u], at[v] = int(i) / grid.size[u];
    size_t next = 0;
    int winding = 0;
    for (int depth = 0; depth < grid.size[axis]; ++depth) {
      for (; next < column.size() && column[next].depth < depth; ++next) winding += column[next].sign;
      at[axis] = depth;
      votes[grid.index(at)] += winding > 0;
    }
  });
}

// Voxels that most axes see enclosed.
std::vector<uint8_t> enclosed(const TriangleMesh& surface, const VoxelGrid& grid) {
  std::vector<uint8_t> votes(grid.count(), 0);
  for (int axis = 0; axis < 3; ++axis) addVotes(surface, axis, grid, votes);
  for (uint8_t& v : votes) v = v >= 2;
  return votes;
}

// Distances from the surface, voxels, positive inside, clamped to the band and smoothed over three voxels.
std::vector<float> smoothDistances(const TriangleMesh& surface, const VoxelGrid& grid,
                                   const std::vector<uint8_t>& inside) {
  const NearestSurface nearest(surface);
  std::vector<float> distance(grid.count());
  inParallel(size_t(grid.size.z), [&](size_t z) {
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::ivec3 at(x, y, int(z));
        const size_t i = grid.index(at);
        float value = kBand;
        if (grid.nearBorder(inside, at, 2))
          if (const auto hit = nearest.nearest(grid.inWorld(at), kBand * float(grid.voxel_m)))
            value = hit->distance_m / float(grid.voxel_m);
        distance[i] = inside[i] ? value : -value;
      }
  });
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> before = distance;
    inParallel(size_t(grid.size.z), [&](size_t z) {
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
          const glm::ivec3 at(x, y, int(z));
          if (at[axis] == 0 || at[axis] == grid.size[axis] - 1) continue;
          const size_t i = grid.index(at), step = grid.step(axis);
          distance[i] = 0.25f * (before[i - step] + 2 * before[i] + before[i + step]);
        }
    });
  }
  return distance;
}

// Fills what the outside cannot reach.
void fillHollows(const VoxelGrid& grid, std::vector<uint8_t>& inside) {
  std::vector<uint8_t> outside(grid.count(), 0);
  std::vector<size_t> open{0};
  outside[0] = 1;
  while (!open.empty()) {
    const size_t i = open.back();
    open.pop_back();
    grid.facing(i, [&](size_t n) {
      if (inside[n] || outside[n]) return;
      outside[n] = 1;
      open.push_back(n);
    });
  }
  for (size_t i = 0; i < inside.size(); ++i) inside[i] = !outside[i];
}

// Neighbourhood of a voxel: bit (z+1) * 9 + (y+1) * 3 + x+1 is set for a voxel of the object.
using Neighbourhood = std::bitset<27>;
constexpr int kCentre = 13;

struct Adjacency {
  std::array<std::vector<int>, 27> all, facing;  // 26- and 6-neighbours within the neighbourhood, without the centre
  std::array<bool, 27> in_18{}, in_6{};
  Adjacency() {
    const auto place = [](int i) { return glm::ivec3(i % 3, i / 3 % 3, i / 9); };
    for (int i = 0; i < 27; ++i) {
      const int far = int(glm::dot(glm::abs(glm::vec3(place(i) - 1)), glm::vec3(1)));
      in_6[size_t(i)] = far == 1, in_18[size_t(i)] = far == 1 || far == 2;
      for (int j = 0; j < 27; ++j) {
        if (i == j || i == kCentre || j == kCentre) continue;
        const glm::ivec3 d = glm::abs(place(i) - place(j));
        if (std::max({d.x, d.y, d.z}) == 1) all[size_t(i)].push_back(j);
        if (d.x + d.y + d.z == 1) facing[size_t(i)].push_back(j);
      }
    }
  }
};
const Adjacency kAdjacency;

// Components of the members that contain one of the seeds.
int components(Neighbourhood members, const Neighbourhood& seeds, const std::array<std::vector<int>, 27>& adjacent) {
  int count = 0;
  std::vector<int> open;
  for (int i = 0; i < 27; ++i) {
    if (!members[size_t(i)] || !seeds[size_t(i)]) continue;
    ++count;
    open = {i};
    members.reset(size_t(i));
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (const int n : adjacent[size_t(at)])
        if (members[size_t(n)]) {
          members.reset(size_t(n));
          open.push_back(n);
        }
    }
  }
  return count;
}

// Adding the centre keeps the topology of the object (26-connected) and of the background (6-connected).
bool isSimple(const Neighbourhood& object) {
  Neighbourhood background, seeds;
  for (size_t i = 0; i < 27; ++i) {
    background[i] = kAdjacency.in_18[i] && !object[i];
    seeds[i] = kAdjacency.in_6[i];
  }
  return components(object, Neighbourhood().set(), kAdjacency.all) == 1 &&
         components(background, seeds, kAdjacency.facing) == 1;
}

// With the centre added, no two voxels of the object, and none of the background, touch in an edge or corner alone.
// Source: Latecki: 3D Well-Composed Pictures. Graphical Models and Image Processing 59, 1997.
bool staysWellComposed(Neighbourhood object) {
  object.set(kCentre);
  const auto in = [&](const glm::ivec3& at) { return object[size_t((at.z + 1) * 9 + (at.y + 1) * 3 + at.x + 1)]; };
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 to(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    for (int axis = 0; axis < 3; ++axis) {  // squares
      glm::ivec3 a(0), b(0), both = to;
      a[(axis + 1) % 3] = to[(axis + 1) % 3], b[(axis + 2) % 3] = to[(axis + 2) % 3], both[axis] = 0;
      if (in(both) && !in(a) && !in(b)) return false;
    }
    int members = 0;
    for (int k = 0; k < 8; ++k) members += in(to * glm::ivec3(k & 1, k >> 1 & 1, k >> 2));
    if (members != 2 && members != 6) continue;
    for (int k = 0; k < 4; ++k) {
      const glm::ivec3 a = to * glm::ivec3(k & 1, k >> 1, 0), b = to - a;
      if (in(a) == in(b) && in(a) == (members == 2)) return false;
    }
  }
  return true;
}

// Grows a ball inside a mask by simple voxels, the deepest first.
class Growth {
 public:
  Growth(const VoxelGrid& grid, const std::vector<uint8_t>& mask, const std::vector<float>& depth)
      : grid_(grid), mask_(mask), depth_(depth), ball_(grid.count(), 0) {}

  std::vector<uint8_t> from(size_t seed) {
    add(seed);
    while (!open_.empty()) {
      const size_t i = open_.top().second;
      open_.pop();
      if (ball_[i]) continue;
      const Neighbourhood around = neighbourhood(i);
      if (isSimple(around) && staysWellComposed(around)) add(i);
    }
    return std::move(ball_);
  }

 private:
  void add(size_t i) {
    ball_[i] = 1;
    grid_.around(i, [&](size_t n, int) {
      if (mask_[n] && !ball_[n]) open_.push({depth_[n], n});
    });
  }
  Neighbourhood neighbourhood(size_t i) const {
    Neighbourhood out;
    grid_.around(i, [&](size_t n, int place) { out[size_t(place)] = ball_[n]; });
    return out;
  }

  const VoxelGrid& grid_;
  const std::vector<uint8_t>& mask_;
  const std::vector<float>& depth_;
  std::vector<uint8_t> ball_;
  std::priority_queue<std::pair<float, size_t>> open_;
};

// Surface nets of a well-composed object: one vertex per cell that the surface crosses. Source: Gibson: Constrained
// Elastic Surface Nets. MICCAI 1998, without the relaxation.
TriangleMesh surfaceNets(const VoxelGrid& grid, const std::vector<uint8_t>& ball, std::vector<float> distance) {
  for (size_t i = 0; i < ball.size(); ++i)
    distance[i] = ball[i] ? std::max(distance[i], kMinDepth) : std::min(distance[i], -kMinDepth);
  constexpr uint32_t kNone = 0xffffffff;
  std::vector<uint32_t> vertices(grid.count(), kNone);  // [first voxel of a cell]
  TriangleMesh mesh;
  const auto vertexOf = [&](const glm::ivec3& cell) {
    uint32_t& vertex = vertices[grid.index(cell)];
    if (vertex != kNone) return vertex;
    glm::dvec3 sum(0);
    int count = 0;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        if (corner >> axis & 1) continue;
        const glm::ivec3 a = cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        const float from = distance[grid.index(a)], to = distance[grid.index(a) + grid.step(axis)];
        if ((from > 0) == (to > 0)) continue;
        glm::dvec3 at(a);
        at[axis] += from / double(from - to);
        sum += at;
        ++count;
      }
    vertex = uint32_t(mesh.positions.size());
    mesh.positions.push_back(glm::vec3(grid.origin_in_world + grid.voxel_m * sum / double(count)));
    return vertex;
  };
  for (int z = 1; z < grid.size.z - 1; ++z)
    for (int y = 1; y < grid.size.y - 1; ++y)
      for (int x = 1; x < grid.size.x - 1; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const glm::ivec3 at(x, y, z);
          const bool here = ball[grid.index(at)];
          if (here == bool(ball[grid.index(at) + grid.step(axis)])) continue;
          glm::ivec3 u(0), v(0);
          u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
          uint32_t q[4] = {vertexOf(at - u - v), vertexOf(at - v), vertexOf(at), vertexOf(at - u)};
          if (!here) std::swap(q[1], q[3]);
          const auto length = [&](int a, int b) { return glm::distance(mesh.positions[q[a]], mesh.positions[q[b]]); };
          const int first = length(0, 2) <= length(1, 3) ? 0 : 1;
          for (const int k : {first, first + 2}) mesh.faces.emplace_back(q[k % 4], q[(k + 1) % 4], q[(k + 2) % 4]);
        }
  return mesh;
}

}  // namespace

Result<GenusZeroSurface> genusZeroSurface(const TriangleMesh& surface, double voxel_m) {
  const VoxelGrid grid(boundsOf(surface.positions), voxel_m, kMargin);
  std::vector<uint8_t> inside = enclosed(surface, grid);
  const std::vector<float> distance = smoothDistances(surface, grid, inside);
  for (size_t i = 0; i < inside.size(); ++i) inside[i] = distance[i] > 0;
  fillHollows(grid, inside);
  const std::vector<float> depth = grid.depths(inside);
  const auto deepest = size_t(std::max_element(depth.begin(), depth.end()) - depth.begin());
  if (!inside[deepest])
    return Error{ErrorId::MeshTopology,
                 "surface: bounds no solid; a person's surface is closed apart from small holes"};
  const std::vector<uint8_t> ball = Growth(grid, inside, depth).from(deepest);
  GenusZeroSurface out;
  out.mesh = surfaceNets(grid, ball, distance);
  const std::vector<uint8_t> part = grid.component(inside, deepest);
  for (size_t i = 0; i < inside.size(); ++i) {
    out.cut_m3 += part[i] && !ball[i];
    out.other_m3 += inside[i] && !part[i];
  }
  out.cut_m3 *= voxel_m * voxel_m * voxel_m;
  out.other_m3 *= voxel_m * voxel_m * voxel_m;
  return out;
}

}  // namespace fourdvt::track
