// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/atlas.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "track/mesh/glue.h"
#include "track/mesh/pack.h"

namespace fourdvt::track {
namespace {

constexpr uint32_t kFacesOfSet = 90;
constexpr int kMinSets = 12, kMaxSets = 160;
constexpr double kUsualCover = 0.6;  // share of the texture, for an estimate of the metres of a texel
constexpr double kLargestRatio = 3;  // between the texels per metre of two charts

Status check(const TriangleMesh& mesh, std::span<const float> resolution, std::span<const float> hidden,
             const AtlasOptions& options) {
  const auto wrong = [](std::string message) { return Error{ErrorId::InvalidArgument, std::move(message)}; };
  const size_t count = mesh.positions.size();
  if (!resolution.empty() && resolution.size() != count)
    return wrong("resolution has " + std::to_string(resolution.size()) + " values for " + std::to_string(count) +
                 " vertices; give one per vertex, or none");
  if (!hidden.empty() && hidden.size() != count)
    return wrong("hidden has " + std::to_string(hidden.size()) + " values for " + std::to_string(count) +
                 " vertices; give one per vertex, or none");
  if (!std::all_of(resolution.begin(), resolution.end(), [](float r) { return r > 0 && std::isfinite(r); }))
    return wrong("resolution has a value that is not above 0; give positive values");
  if (!std::all_of(hidden.begin(), hidden.end(), [](float h) { return h >= 0 && h <= 1; }))
    return wrong("hidden has a value outside 0 to 1; give shares");
  if (options.texels < 16 || options.gutter_texels < 0 || options.gutter_texels > options.texels / 4)
    return wrong("an atlas of " + std::to_string(options.texels) + " texels a side with gutters of " +
                 std::to_string(options.gutter_texels) +
                 " is not possible; choose at least 16 texels and a gutter of " + "at most a quarter");
  return {};
}

struct Share {
  double log_resolution, area;
};

// Limits the resolutions of charts to a range of kLargestRatio, the one that moves the least area.
void limit(std::vector<Share>& shares) {
  double best = 0, least = 1e300;
  for (const Share& candidate : shares)
    for (const double low : {candidate.log_resolution, candidate.log_resolution - std::log(kLargestRatio)}) {
      double moved = 0;
      for (const Share& s : shares)
        moved += s.area * std::abs(s.log_resolution - std::clamp(s.log_resolution, low, low + std::log(kLargestRatio)));
      if (moved < least) least = moved, best = low;
    }
  for (Share& s : shares) s.log_resolution = std::clamp(s.log_resolution, best, best + std::log(kLargestRatio));
}

// Factor of each chart from its metres to the common unit.
std::vector<double> scalesOf(const Surface& s, const std::vector<Patch>& patches) {
  std::vector<Share> shares;
  for (const Patch& patch : patches) {
    double area = 0, sum = 0;
    for (const uint32_t f : patch.faces) area += s.areas[f], sum += s.areas[f] * s.resolution[f];
    shares.push_back({area > 0 ? std::log(sum / area) : 0, area});
  }
  limit(shares);
  std::vector<double> scales;
  for (const Share& share : shares) scales.push_back(std::exp(share.log_resolution));
  return scales;
}

MeshTopology topologyOf(const TriangleMesh& mesh, const std::vector<Patch>& patches,
                        const std::vector<PackedChart>& packed, int texels) {
  MeshTopology out;
  out.vertex_count = uint32_t(mesh.positions.size());
  out.face_vertices = mesh.faces;
  out.face_uvs.resize(mesh.faces.size());
  for (size_t c = 0; c < patches.size(); ++c) {
    const uint32_t first = uint32_t(out.uvs.size());
    for (const glm::dvec2& p : packed[c].points) out.uvs.emplace_back(p / double(texels));
    for (size_t i = 0; i < patches[c].faces.size(); ++i)
      out.face_uvs[patches[c].faces[i]] = patches[c].corners[i] + first;
  }
  return out;
}

}  // namespace

Result<MeshTopology> unwrapped(const TriangleMesh& mesh, std::span<const float> resolution,
                               std::span<const float> hidden, const AtlasOptions& options) {
  FOURDVT_TRY(check(mesh, resolution, hidden, options));
  FOURDVT_ASSIGN(const Surface surface, surfaceOf(mesh, resolution, hidden));
  double area = 0;
  for (const double a : surface.areas) area += a;
  GlueLimits limits;
  limits.gap_m = options.gutter_texels * std::sqrt(area / kUsualCover) / options.texels;
  const int sets = std::clamp(int(surface.faceCount() / kFacesOfSet), kMinSets, kMaxSets);
  const std::vector<Patch> patches = gluedCharts(surface, grownSets(surface, sets), limits);
  const std::vector<double> scales = scalesOf(surface, patches);
  std::vector<PackedChart> packed;
  for (size_t c = 0; c < patches.size(); ++c) {
    packed.push_back({{}, patches[c].border_vertices});
    for (const glm::dvec2& p : patches[c].flat) packed[c].points.emplace_back(scales[c] * p.x, -scales[c] * p.y);
  }
  if (!pack(packed, options.texels, options.gutter_texels))
    return Error{ErrorId::InvalidArgument, std::to_string(packed.size()) + " charts with gutters of " +
                                               std::to_string(options.gutter_texels) + " texels do not fit into " +
                                               std::to_string(options.texels) + " texels; choose a larger texture"};
  return topologyOf(mesh, patches, packed, options.texels);
}

}  // namespace fourdvt::track
