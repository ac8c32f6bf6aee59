// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_cleaning.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "base/mesh.h"
#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kSpeckShare = 1e-3, kNeededShare = 0.1;

struct Component {
  double volume_m3 = 0;
  std::vector<uint32_t> faces;
};

uint32_t rootOf(std::vector<uint32_t>& parent, uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

// Connected components, by decreasing volume.
std::vector<Component> componentsOf(const TriangleMesh& mesh) {
  std::vector<uint32_t> parent(mesh.positions.size()), index(mesh.positions.size(), UINT32_MAX);
  std::iota(parent.begin(), parent.end(), 0u);
  for (const glm::uvec3& face : mesh.faces)
    for (int k = 1; k < 3; ++k) parent[rootOf(parent, face[k])] = rootOf(parent, face[0]);
  std::vector<Component> out;
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const glm::uvec3& face = mesh.faces[f];
    uint32_t& at = index[rootOf(parent, face.x)];
    if (at == UINT32_MAX) {
      at = uint32_t(out.size());
      out.emplace_back();
    }
    const glm::dvec3 near(mesh.positions[mesh.faces.front().x]);
    const glm::dvec3 a = glm::dvec3(mesh.positions[face.x]) - near, b = glm::dvec3(mesh.positions[face.y]) - near,
                     c = glm::dvec3(mesh.positions[face.z]) - near;
    out[at].volume_m3 += glm::dot(a, glm::cross(b, c)) / 6;
    out[at].faces.push_back(f);
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.volume_m3 > b.volume_m3; });
  return out;
}

// Mask of the component in the camera's picture, 255 inside.
cv::Mat drawn(const PinholeCamera& camera, const TriangleMesh& mesh, const Component& component) {
  cv::Mat out(camera.height, camera.width, CV_8U, cv::Scalar(0));
  for (const uint32_t f : component.faces) {
    cv::Point corners[3];
    bool before = true;
    for (int k = 0; k < 3 && before; ++k) {
      const glm::dvec3 p = camera.project(glm::dvec3(mesh.positions[mesh.faces[f][k]]));
      before = p.z > 0 && std::abs(p.x) < 1e5 && std::abs(p.y) < 1e5;
      if (before) corners[k] = {int(std::floor(p.x)), int(std::floor(p.y))};
    }
    if (before) cv::fillConvexPoly(out, corners, 3, cv::Scalar(255));
  }
  return out;
}

void keepOnly(TriangleMesh& mesh, const std::vector<Component>& components, const std::vector<bool>& keep) {
  std::vector<uint8_t> stays(mesh.faces.size(), 0);
  for (size_t i = 0; i < components.size(); ++i)
    for (const uint32_t f : components[i].faces) stays[f] = keep[i];
  std::vector<uint32_t> index(mesh.positions.size(), UINT32_MAX);
  TriangleMesh kept;
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (!stays[f]) continue;
    glm::uvec3 corners;
    for (int k = 0; k < 3; ++k) {
      uint32_t& at = index[mesh.faces[f][k]];
      if (at == UINT32_MAX) {
        at = uint32_t(kept.positions.size());
        kept.positions.push_back(mesh.positions[mesh.faces[f][k]]);
      }
      corners[k] = at;
    }
    kept.faces.push_back(corners);
  }
  mesh = std::move(kept);
}

double minVolume(const std::vector<Component>& components, double min_volume_m3) {
  return std::max(components.front().volume_m3 * kSpeckShare, min_volume_m3);
}

// Keeps the largest component and those selected by `choose`. Returns the number of removed components.
template <class Choose>
size_t dropOthers(TriangleMesh& mesh, const Choose& choose) {
  if (mesh.faces.empty()) return 0;
  const std::vector<Component> components = componentsOf(mesh);
  std::vector<bool> keep(components.size(), false);
  keep[0] = true;
  choose(components, keep);
  const auto dropped = size_t(std::count(keep.begin(), keep.end(), false));
  if (dropped > 0) keepOnly(mesh, components, keep);
  return dropped;
}

}  // namespace

size_t dropSpecks(TriangleMesh& mesh, double min_volume_m3) {
  return dropOthers(mesh, [&](const std::vector<Component>& components, std::vector<bool>& keep) {
    const double least = minVolume(components, min_volume_m3);
    for (size_t i = 1; i < components.size(); ++i) keep[i] = std::abs(components[i].volume_m3) >= least;
  });
}

size_t dropNeedless(TriangleMesh& mesh, std::span<const silhouette::Silhouette* const> silhouettes,
                    double min_volume_m3) {
  return dropOthers(mesh, [&](const std::vector<Component>& components, std::vector<bool>& keep) {
    const double least = minVolume(components, min_volume_m3);
    std::vector<cv::Mat> explained;  // [camera] mask of the components kept so far
    for (size_t i = 1; i < components.size(); ++i) {
      const double volume = components[i].volume_m3;
      if (volume < 0) keep[i] = -volume >= least;
      if (volume < least) continue;
      if (explained.empty())
        for (const silhouette::Silhouette* s : silhouettes) explained.push_back(drawn(s->camera, mesh, components[0]));
      std::vector<cv::Mat> own;
      for (size_t c = 0; c < silhouettes.size(); ++c) {
        own.push_back(drawn(silhouettes[c]->camera, mesh, components[i]));
        const int area = cv::countNonZero(own[c]), needed = cv::countNonZero(own[c] & ~explained[c]);
        if (area > 0 && needed > kNeededShare * area) keep[i] = true;
      }
      if (keep[i])
        for (size_t c = 0; c < own.size(); ++c) explained[c] |= own[c];
    }
  });
}

size_t dropUnseen(TriangleMesh& mesh, std::span<const PinholeCamera> cameras, size_t min_cameras) {
  std::vector<uint8_t> seen(mesh.positions.size());
  for (size_t v = 0; v < seen.size(); ++v) {
    size_t count = 0;
    for (const PinholeCamera& camera : cameras) {
      const glm::dvec3 p = camera.project(glm::dvec3(mesh.positions[v]));
      count += p.z > 0 && p.x >= 0 && p.y >= 0 && p.x <= camera.width && p.y <= camera.height;
    }
    seen[v] = count >= min_cameras;
  }
  if (std::find(seen.begin(), seen.end(), uint8_t(0)) == seen.end()) return 0;
  const std::vector<Component> components = componentsOf(mesh);
  std::vector<bool> keep;
  for (const Component& component : components) {
    size_t corners = 0;
    for (const uint32_t f : component.faces)
      for (int k = 0; k < 3; ++k) corners += seen[mesh.faces[f][k]];
    keep.push_back(2 * corners >= 3 * component.faces.size());
  }
  const auto dropped = size_t(std::count(keep.begin(), keep.end(), false));
  if (dropped > 0) keepOnly(mesh, components, keep);
  return dropped;
}

size_t dropHollows(TriangleMesh& mesh) {
  return dropOthers(mesh, [](const std::vector<Component>& components, std::vector<bool>& keep) {
    for (size_t i = 1; i < components.size(); ++i) keep[i] = components[i].volume_m3 >= 0;
  });
}

namespace {

constexpr float kStep = 0.5f;
constexpr float kBeyond_px = 0.25f;  // maximum distance of a vertex outside a silhouette
constexpr int kHalvings = 5;

// Vertex pairs of all edges, each twice.
std::vector<std::pair<uint32_t, uint32_t>> edgesOf(const TriangleMesh& mesh) {
  std::vector<std::pair<uint32_t, uint32_t>> out;
  out.reserve(mesh.faces.size() * 3);
  for (const glm::uvec3& f : mesh.faces)
    for (int k = 0; k < 3; ++k) out.emplace_back(f[k], f[(k + 1) % 3]);
  return out;
}

// Moves each vertex by `share` of the way to the mean of its neighbours.
void relax(Positions& positions, const std::vector<std::pair<uint32_t, uint32_t>>& edges, float share) {
  std::vector<glm::vec3> sum(positions.size(), glm::vec3(0));
  std::vector<float> count(positions.size(), 0);
  for (const auto& [a, b] : edges) {  // a closed surface has every edge once in each direction
    sum[a] += positions[b];
    count[a] += 1;
  }
  for (size_t v = 0; v < positions.size(); ++v)
    if (count[v] > 0) positions[v] += share * (sum[v] / count[v] - positions[v]);
}

// Minimum signed distance of a point over the silhouettes, pixels; negative outside.
float clearance(std::span<const CarvingView> views, const glm::vec3& point) {
  float least = silhouette::SilhouetteDistance::kOutside;
  for (const CarvingView& view : views) {
    const glm::dvec3 p = view.silhouette->camera.project(glm::dvec3(point));
    if (p.z > 0) least = std::min(least, view.distance.at(p.x, p.y));
  }
  return least;
}

}  // namespace

int fairSurface(TriangleMesh& mesh, std::span<const CarvingView> views, int rounds,
                const std::function<bool(const TriangleMesh&)>& still_good) {
  const auto edges = edgesOf(mesh);
  for (int round = 0; round < rounds; ++round) {
    const Positions before = mesh.positions;
    relax(mesh.positions, edges, kStep);
    inParallel(before.size(), [&](int v) {
      const float least = std::min(-kBeyond_px, clearance(views, before[v]));
      glm::vec3& p = mesh.positions[v];
      for (int half = 0; half < kHalvings && clearance(views, p) < least; ++half) p = 0.5f * (p + before[v]);
      if (clearance(views, p) < least) p = before[v];
    });
    if (still_good(mesh)) continue;
    mesh.positions = before;
    return round;
  }
  return rounds;
}

namespace {

constexpr float kAnyError = 1;  // relative to the mesh's extent: only the number of faces is limited

}  // namespace

void simplify(TriangleMesh& mesh, size_t max_faces) {
  if (mesh.faces.size() <= max_faces) return;
  std::vector<glm::uvec3> kept(mesh.faces.size());
  const size_t indices =
      meshopt_simplify(&kept[0].x, &mesh.faces[0].x, 3 * mesh.faces.size(), &mesh.positions[0].x, mesh.positions.size(),
                       sizeof(glm::vec3), 3 * max_faces, kAnyError, 0, nullptr);
  kept.resize(indices / 3);
  mesh.faces = std::move(kept);
  dropUnusedVertices(mesh);
}

}  // namespace fourdvt::reconstruct
