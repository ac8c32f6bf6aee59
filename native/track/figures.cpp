// SPDX-License-Identifier: Apache-2.0
#include "track/figures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/face_buffer.h"
#include "base/parallel.h"
#include "base/robust.h"

namespace fourdvt::track {
namespace {

constexpr float kComparedSeen = 0.2f;    // visibilityOf of places that are compared
constexpr float kFar_m = 0.3f;           // longest distance that is looked for
constexpr float kComparedCosine = 0.4f;  // between normals of corresponding places
constexpr double kLost_m = 0.03;         // distance of parts that lie elsewhere
constexpr size_t kMinPixels = 200;       // smallest silhouette that counts

// Intersection over union of the mesh and the matte in a crop; negative: too small to count.
double silhouetteOverlap(const View& view, const FaceBuffer& buffer) {
  size_t both = 0, either = 0;
  for (int y = 0; y < buffer.height; ++y)
    for (int x = 0; x < buffer.width; ++x) {
      const bool mesh = buffer.face[size_t(y) * size_t(buffer.width) + size_t(x)] != FaceBuffer::kNoFace;
      const bool matte = view.matte.at<uint8_t>(y, x) >= 128;
      both += mesh && matte;
      either += mesh || matte;
    }
  return either < kMinPixels ? -1 : double(both) / double(either);
}

// Distances from every stride-th seen point to a surface; negative: not seen. Adds them, and keeps the largest.
std::vector<double> addDistances(const Positions& points, std::span<const glm::vec3> normals,
                                 std::span<const float> seen, size_t stride, const NearestSurface& to,
                                 std::vector<double>& distances, FitFigures& out) {
  std::vector<double> found(points.size() / stride, -1);
  inParallel(found.size(), [&](size_t i) {
    const size_t v = i * stride;
    if (seen[v] < kComparedSeen) return;
    const auto hit = to.nearestFacing(points[v], normals[v], kComparedCosine, kFar_m);
    found[i] = hit ? double(hit->distance_m) : double(kFar_m);
  });
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i] < 0) continue;
    distances.push_back(found[i]);
    if (found[i] > out.distance_max_m) out.distance_max_m = found[i], out.farthest = points[i * stride];
  }
  return found;
}

// Grey of seen vertices in a camera, blurred; negative: not seen.
std::vector<float> greysOf(const View& view, const std::vector<glm::uvec3>& faces, const Positions& positions,
                           std::span<const glm::vec3> normals) {
  std::vector<float> out(positions.size(), -1);
  if (view.empty()) return out;
  const std::vector<float> seen = visibilityOf({view}, faces, positions, normals);
  cv::Mat blurred;
  cv::GaussianBlur(view.grey, blurred, {5, 5}, 0);
  for (size_t v = 0; v < out.size(); ++v) {
    if (seen[v] < kComparedCosine) continue;
    const glm::dvec3 at = view.camera.project(positions[v]);
    const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
    if (x >= 0 && y >= 0 && x < blurred.cols && y < blurred.rows && view.matte.at<uint8_t>(y, x) >= 250)
      out[v] = blurred.at<uint8_t>(y, x);
  }
  return out;
}

double colourError(const Template& model, const Positions& positions, const PosedViews& anchor,
                   const std::vector<View>& views) {
  const auto& faces = model.topology.face_vertices;
  const auto there = normalsOf(faces, *anchor.positions), here = normalsOf(faces, positions);
  std::vector<std::vector<double>> errors(views.size());
  inParallel(views.size(), [&](size_t c) {
    const std::vector<float> a = greysOf((*anchor.views)[c], faces, *anchor.positions, there);
    const std::vector<float> b = greysOf(views[c], faces, positions, here);
    for (size_t v = 0; v < a.size(); ++v)
      if (a[v] >= 0 && b[v] >= 0) errors[c].push_back(double(b[v]) - a[v]);
  });
  double sum = 0;
  size_t count = 0;
  for (const std::vector<double>& of_camera : errors) {
    if (of_camera.empty()) continue;
    const double shift = quantile(of_camera, 0.5);  // brighter or darker as a whole
    for (const double e : of_camera) sum += std::abs(e - shift);
    count += of_camera.size();
  }
  return count ? sum / double(count) : 0;
}

void countBadFaces(const Template& model, const FittedFrame& fitted, FitFigures& out) {
  const std::vector<glm::dmat3> rotations = vertexRotations(model.graph, fitted.pose);
  for (const glm::uvec3& f : model.topology.face_vertices) {
    const auto normal = [&](const Positions& p) {
      return glm::cross(glm::dvec3(p[f.y]) - glm::dvec3(p[f.x]), glm::dvec3(p[f.z]) - glm::dvec3(p[f.x]));
    };
    out.flipped_faces += glm::dot(rotations[f.x] * normal(model.positions), normal(fitted.positions)) < 0;
    bool stretched = false;
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = f[k], b = f[(k + 1) % 3];
      const double rest = glm::distance(model.positions[a], model.positions[b]);
      const double now = glm::distance(fitted.positions[a], fitted.positions[b]);
      stretched = stretched || now > 2 * rest || now < rest / 2;
    }
    out.stretched_faces += stretched;
  }
}

}  // namespace

Overlap overlapWith(const std::vector<glm::uvec3>& faces, const Positions& positions, const std::vector<View>& views) {
  std::vector<double> overlaps(views.size(), -1);
  inParallel(views.size(), [&](size_t c) {
    if (!views[c].empty()) overlaps[c] = silhouetteOverlap(views[c], rasterise(views[c].camera, faces, positions, 1));
  });
  Overlap out;
  int cameras = 0;
  for (uint32_t c = 0; c < overlaps.size(); ++c) {
    if (overlaps[c] < 0) continue;
    ++cameras;
    out.mean += overlaps[c];
    if (overlaps[c] < out.lowest) out.lowest = overlaps[c], out.lowest_camera = c;
  }
  if (cameras) out.mean /= cameras;
  return out;
}

FitFigures figuresOf(const Template& model, const FittedFrame& fitted, const PosedViews& anchor,
                     const TargetFrame& target) {
  FitFigures out;
  const auto& faces = model.topology.face_vertices;
  const std::vector<View>& views = *target.views;
  out.overlap = overlapWith(faces, fitted.positions, views);
  const std::vector<glm::vec3> normals = normalsOf(faces, fitted.positions);
  const std::vector<float> seen = visibilityOf(views, faces, fitted.positions, normals);
  double area = 0, seen_area = 0;
  for (const glm::uvec3& f : faces) {
    const glm::dvec3 a = fitted.positions[f.x], b = fitted.positions[f.y], c = fitted.positions[f.z];
    const double face_area = glm::length(glm::cross(b - a, c - a));
    area += face_area;
    for (int k = 0; k < 3; ++k) seen_area += seen[f[k]] >= kComparedSeen ? face_area / 3 : 0;
  }
  out.seen_share = area > 0 ? seen_area / area : 0;

  std::vector<double> distances;
  const auto found = addDistances(fitted.positions, normals, seen, 1, *target.nearest, distances, out);
  out.vertex_distance_m.assign(found.begin(), found.end());
  const TriangleMesh& surface = *target.surface;
  const std::vector<glm::vec3> surface_normals = normalsOf(surface.faces, surface.positions);
  addDistances(surface.positions, surface_normals,
               visibilityOf(views, surface.faces, surface.positions, surface_normals),
               std::max<size_t>(1, surface.positions.size() / fitted.positions.size()),
               NearestSurface({fitted.positions, faces}), distances, out);
  out.distance_95_m = quantile(distances, 0.95);
  const auto lost = std::count_if(distances.begin(), distances.end(), [](double d) { return d > kLost_m; });
  out.lost_share = distances.empty() ? 0 : double(lost) / double(distances.size());
  countBadFaces(model, fitted, out);
  out.colour_error = colourError(model, fitted.positions, anchor, views);
  return out;
}

}  // namespace fourdvt::track
