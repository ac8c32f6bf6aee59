// SPDX-License-Identifier: Apache-2.0
// Source: Mario Botsch, Leif Kobbelt: A Remeshing Approach to Multiresolution Modeling. Eurographics Symposium on
// Geometry Processing (SGP), 2004. Differences: lengths follow a size, changes keep to the surface one by one, and the
// target length is found from the number of faces.
#include "track/mesh/remesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "track/mesh/half_edges.h"
#include "track/mesh/remesher.h"

namespace fourdvt::track {
namespace {

constexpr double kTolerance = 0.02;  // tolerance, share of the number of faces
constexpr int kRelaxations = 3, kFinalRounds = 3;

Status checkInput(const TriangleMesh& surface, std::span<const float> size, const RemeshOptions& options) {
  if (options.faces < 4 || options.rounds < 1)
    return Error{ErrorId::InvalidArgument, "remeshing: at least 4 faces and 1 round are necessary"};
  const size_t count = surface.positions.size();
  for (size_t f = 0; f < surface.faces.size(); ++f)
    if (glm::any(glm::greaterThanEqual(surface.faces[f], glm::uvec3(uint32_t(count)))))
      return Error{ErrorId::MeshIndex, printed("surface: face %zu has an index of %zu vertices or more", f, count)};
  for (size_t v = 0; v < count; ++v)
    if (glm::any(glm::isnan(surface.positions[v])) || glm::any(glm::isinf(surface.positions[v])))
      return Error{ErrorId::MeshNotFinite, printed("surface: vertex %zu is not finite", v)};
  if (surface.faces.empty()) return Error{ErrorId::MeshTopology, "surface: there are no faces to remesh"};
  if (!size.empty() && size.size() != count)
    return Error{ErrorId::MeshTopology, printed("surface: %zu sizes for %zu vertices", size.size(), count)};
  for (size_t v = 0; v < size.size(); ++v)
    if (!(size[v] > 0) || !std::isfinite(size[v]))
      return Error{ErrorId::InvalidArgument, printed("surface: the size of vertex %zu is not above 0", v)};
  return {};
}

void runRounds(Remesher& remesher, const RemeshOptions& options) {
  double length = std::sqrt(remesher.relativeArea() / options.faces * 4 / std::sqrt(3.0));
  for (int round = 0; round < options.rounds; ++round) {
    if (round > 0) length *= std::sqrt(double(remesher.faceCount()) / options.faces);
    remesher.splitLong(float(length));
    remesher.collapseShort(float(length));
    remesher.flipEdges(true);
    for (int k = 0; k < kRelaxations; ++k) remesher.relax();
  }
  for (int round = 0; round < kFinalRounds; ++round) {
    remesher.trim(options.faces, float(length));
    remesher.flipEdges(round + 1 < kFinalRounds);
    for (int k = 0; k < kRelaxations; ++k) remesher.relax();
    remesher.flipEdges(false);
  }
}

}  // namespace

Result<TriangleMesh> remeshed(const TriangleMesh& surface, std::span<const float> size, const RemeshOptions& options) {
  FOURDVT_TRY(checkInput(surface, size, options));
  Positions positions = surface.positions;
  FOURDVT_ASSIGN(HalfEdges mesh, HalfEdges::of(surface.faces, positions));
  Remesher remesher(surface, size, std::move(mesh), std::move(positions));
  runRounds(remesher, options);
  TriangleMesh out = remesher.result();
  if (std::abs(double(out.faces.size()) - options.faces) > kTolerance * options.faces)
    return Error{ErrorId::MeshTopology,
                 printed("surface: its parts allow %zu faces rather than %u; choose about as many", out.faces.size(),
                         options.faces)};
  dropUnusedVertices(out);
  return out;
}

}  // namespace fourdvt::track
