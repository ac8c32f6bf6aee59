// SPDX-License-Identifier: Apache-2.0
#include "track/template.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "base/text.h"
#include "track/graph.h"
#include "track/limbs.h"
#include "track/mesh/atlas.h"
#include "track/mesh/remesh.h"

namespace fourdvt::track {
namespace {

constexpr float kFitSeen = 0.5f;                    // cosine between normal and direction to the camera
constexpr double kMinCovered = 0.7;                 // overlap of the surface and the mattes of its frame
constexpr double kMaxOther = 0.25;                  // share of the volume in another part: a second person
constexpr double kMinSight = 0.5;                   // share of the surface
constexpr double kMaxCut = 0.0025;                  // share of the volume; more is a part in contact
constexpr int kSmoothings = 12;                     // rounds over curvature, along edges
constexpr float kMinSize = 0.55f, kMaxSize = 1.4f;  // edge lengths relative to the median's
constexpr float kMinResolution = 0.4f;              // least, relative to the median; for places that no camera sees

double areaOf(const TriangleMesh& mesh, const glm::uvec3& f) {
  const glm::dvec3 a = mesh.positions[f.x], b = mesh.positions[f.y], c = mesh.positions[f.z];
  return glm::length(glm::cross(b - a, c - a)) / 2;
}

double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& f : mesh.faces)
    sum += glm::dot(glm::dvec3(mesh.positions[f.x]),
                    glm::cross(glm::dvec3(mesh.positions[f.y]), glm::dvec3(mesh.positions[f.z])));
  return sum / 6;
}

void smooth(std::span<const glm::uvec2> edges, std::vector<float>& values) {
  std::vector<float> sums = values;
  std::vector<int> counts(values.size(), 1);
  for (const glm::uvec2& e : edges) {
    sums[e.x] += values[e.y], sums[e.y] += values[e.x];
    ++counts[e.x], ++counts[e.y];
  }
  for (size_t v = 0; v < values.size(); ++v) values[v] = sums[v] / float(counts[v]);
}

std::vector<float> relative(std::vector<float> values, float low, float high) {
  const auto middle = float(quantile(std::vector<double>(values.begin(), values.end()), 0.5));
  for (float& v : values) v = middle > 0 ? std::clamp(v / middle, low, high) : 1.f;
  return values;
}

// [vertex] relative edge lengths: a chord's distance from a curve is as the square of its length times the curvature.
std::vector<float> sizesOf(const TriangleMesh& surface, std::span<const glm::vec3> normals,
                           std::span<const float> resolution) {
  const std::vector<glm::uvec2> edges = edgesOf(surface.faces);
  std::vector<float> curvature(surface.positions.size(), 0);
  for (const glm::uvec2& e : edges) {
    const float length = glm::distance(surface.positions[e.x], surface.positions[e.y]);
    const float bend = length > 0 ? glm::distance(normals[e.x], normals[e.y]) / length : 0;
    for (const uint32_t v : {e.x, e.y}) curvature[v] = std::max(curvature[v], bend);
  }
  for (int i = 0; i < kSmoothings; ++i) smooth(edges, curvature);
  std::vector<float> out(curvature.size());
  for (size_t v = 0; v < out.size(); ++v) out[v] = 1 / std::sqrt(std::max(curvature[v], 1.f) * resolution[v]);
  out = relative(std::move(out), kMinSize, kMaxSize);
  for (int i = 0; i < kSmoothings; ++i) smooth(edges, out);
  return out;
}

// [vertex] pixels per metre in the camera that resolves it best, relative to the median.
std::vector<float> resolutionOf(const TriangleMesh& surface, const std::vector<View>& views,
                                std::span<const float> seen) {
  std::vector<float> out(surface.positions.size(), 0);
  for (const View& view : views) {
    if (view.empty()) continue;
    const glm::dvec3 centre = view.camera.centreInWorld();
    for (size_t v = 0; v < out.size(); ++v) {
      const double distance = glm::distance(centre, glm::dvec3(surface.positions[v]));
      out[v] = std::max(out[v], float(view.camera.fx / distance));
    }
  }
  for (size_t v = 0; v < out.size(); ++v) out[v] *= std::max(seen[v], kMinResolution);
  return relative(std::move(out), kMinResolution, 3 * kMinResolution);
}

}  // namespace

TemplateFitness fitnessOf(const TriangleMesh& surface, double cut_m3, double other_m3, const std::vector<View>& views) {
  const std::vector<float> seen =
      visibilityOf(views, surface.faces, surface.positions, normalsOf(surface.faces, surface.positions));
  TemplateFitness out;
  for (const glm::uvec3& f : surface.faces) {
    const double area = areaOf(surface, f);
    out.area_m2 += area;
    int corners = 0;
    for (int k = 0; k < 3; ++k) corners += seen[f[k]] >= kFitSeen;
    out.seen_m2 += area * corners / 3;
  }
  const LimbOptions limbs;
  for (const Limb& limb : limbsOf(surface, limbs)) out.limbs_m += limbs.step_m * double(limb.rings.size());
  const double volume = volumeOf(surface) + cut_m3;
  if (volume > 0) out.cut_share = cut_m3 / volume, out.other_share = other_m3 / volume;
  return out;
}

std::string templateProblem(const TemplateFitness& f, double overlap, bool given) {
  if (overlap < kMinCovered)
    return printed(
        "its surface covers the mattes by %.2f only (1 is perfect): it was not made of these pictures; run "
        "`fourdvt reconstruct` on this capture",
        overlap);
  if (f.other_share > kMaxOther)
    return printed(
        "a second part has %.0f %% of the volume: track follows one performer; leave the others out of the "
        "mattes",
        100 * f.other_share);
  if (f.seen_m2 < kMinSight * f.area_m2)
    return printed("cameras see %.0f %% of the surface; tracking needs at least half. Film from more sides",
                   100 * f.seen_m2 / f.area_m2);
  if (f.cut_share > kMaxCut && given)
    return printed(
        "parts of the body touch each other there, hands on hips for example (%.1f %% of the volume); choose "
        "a frame with limbs apart, or leave out --template",
        100 * f.cut_share);
  return {};
}

Result<TemplateMesh> templateMesh(const TriangleMesh& surface, const std::vector<View>& views,
                                  const TemplateOptions& options) {
  const std::vector<glm::vec3> normals = normalsOf(surface.faces, surface.positions);
  const std::vector<float> seen = visibilityOf(views, surface.faces, surface.positions, normals);
  const std::vector<float> sizes = sizesOf(surface, normals, resolutionOf(surface, views, seen));
  FOURDVT_ASSIGN(TriangleMesh mesh, remeshed(surface, sizes, {options.faces, 8}));
  const std::vector<float> seen_there =
      visibilityOf(views, mesh.faces, mesh.positions, normalsOf(mesh.faces, mesh.positions));
  std::vector<float> hidden(seen_there.size());
  for (size_t v = 0; v < hidden.size(); ++v) hidden[v] = 1 - seen_there[v];
  const std::vector<float> resolution = resolutionOf(mesh, views, seen_there);
  FOURDVT_ASSIGN(MeshTopology topology, unwrapped(mesh, resolution, hidden, {options.texels, options.gutter_texels}));
  return TemplateMesh{std::move(topology), std::move(mesh.positions)};
}

}  // namespace fourdvt::track
