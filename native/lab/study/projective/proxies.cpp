// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/proxies.h"

#include <cmath>
#include <filesystem>

#include "base/text.h"
#include "capture/mesh_file.h"
#include "encode/surfaces.h"
#include "lab/study/run/projective_rows.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

constexpr int kPlaneQuads = 32;
constexpr double kWave_m = 0.3;

reconstruct::ReconstructOptions hullOptions(double tolerance_px) {
  reconstruct::ReconstructOptions options;
  options.hull = reconstruct::HullKind::Polyhedral;
  options.contour_tolerance_px = tolerance_px;
  options.stereo = false;
  return options;
}

// Reconstruction options of a proxy; nullopt if it is not made from pictures.
std::optional<reconstruct::ReconstructOptions> optionsOf(const std::string& proxy) {
  if (proxy == rows::kProxyRefined) return reconstruct::ReconstructOptions{};
  if (proxy == rows::kProxyHull) return hullOptions(1);
  if (proxy == "hull-2px") return hullOptions(2);
  if (proxy == "hull-4px") return hullOptions(4);
  return std::nullopt;
}

}  // namespace

Result<TriangleMesh> Proxies::reconstructed(const std::string& proxy, FrameWindow& frames, uint32_t frame) {
  const std::string& sequence = frames.sequence().name;
  const std::string name = printed("/%06u.ply", frame);
  const std::string folder = folder_ + "/" + proxy + "/" + sequence, path = folder + name;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return capture::readMeshFile(path);
  auto found = makers_.find(proxy);
  if (found == makers_.end()) {
    FOURDVT_ASSIGN(auto maker, reconstruct::SurfaceMaker::create(*optionsOf(proxy), capture_.cameras, &device_));
    found = makers_.emplace(proxy, Maker{std::move(maker), sequence, 0}).first;
  }
  Maker& maker = found->second;
  if (maker.sequence != sequence || maker.next != frame) maker.surfaces.forget();
  FOURDVT_ASSIGN(const auto* captured, frames.at(frame));
  FOURDVT_ASSIGN(auto made, maker.surfaces.make(captured->pictures));
  maker.sequence = sequence;
  maker.next = frame + 1;
  FOURDVT_TRY(platform::makeFolder(folder));
  FOURDVT_TRY(platform::writeFileAtomic(path, capture::plyBytes(made.mesh)));
  return std::move(made.mesh);
}

Result<TriangleMesh> Proxies::surface(const std::string& proxy, FrameWindow& frames, uint32_t frame) {
  if (optionsOf(proxy)) return reconstructed(proxy, frames, frame);
  FOURDVT_ASSIGN(auto given, capture::readSurfaceFrame(capture_, frames.sequence(), frame));
  if (proxy == rows::kProxyGiven) return given;
  if (proxy == "given-2000") return encode::simplified(std::move(given), 2000);
  if (proxy == "given-500") return encode::simplified(std::move(given), 500);
  return Error{ErrorId::InvalidArgument, "there is no proxy " + proxy};
}

TriangleMesh facingPlane(const Positions& surface, const PinholeCamera& view) {
  const BoundingBox box = boundsOf(surface);
  const glm::dvec3 middle = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
  const glm::dvec3 towards = glm::normalize(view.centreInWorld() - middle);
  const glm::dvec3 upright = std::abs(towards.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 right = glm::normalize(glm::cross(upright, towards)), up = glm::cross(towards, right);
  // Points nearer to the view than the plane project further out on it.
  double across = 0, along = 0;
  for (const glm::vec3& p : surface) {
    const glm::dvec3 d = glm::dvec3(p) - middle;
    const double depth = glm::length(view.centreInWorld() - middle), scale = depth / (depth - glm::dot(d, towards));
    across = std::max(across, scale * std::abs(glm::dot(d, right)));
    along = std::max(along, scale * std::abs(glm::dot(d, up)));
  }
  TriangleMesh out;
  for (int y = 0; y <= kPlaneQuads; ++y)
    for (int x = 0; x <= kPlaneQuads; ++x)
      out.positions.push_back(
          glm::vec3(middle + across * (2.0 * x / kPlaneQuads - 1) * right + along * (2.0 * y / kPlaneQuads - 1) * up));
  for (uint32_t y = 0; y < kPlaneQuads; ++y)
    for (uint32_t x = 0; x < kPlaneQuads; ++x) {
      const uint32_t a = y * (kPlaneQuads + 1) + x, b = a + 1, c = a + kPlaneQuads + 2, d = c - 1;
      out.faces.push_back({a, b, c});
      out.faces.push_back({a, c, d});
    }
  return out;
}

TriangleMesh stoodOff(TriangleMesh surface, double largest_mm) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(surface.faces, surface.positions.data(), surface.positions.size(), normals);
  const double k = 2 * 3.14159265358979323846 / kWave_m;
  for (size_t v = 0; v < surface.positions.size(); ++v) {
    const glm::dvec3 p(surface.positions[v]);
    const double wave = std::sin(k * p.x + 1) * std::cos(k * p.y) * std::cos(0.7 * k * p.z + 2);
    surface.positions[v] += float(1e-3 * largest_mm * wave) * normals[v];
  }
  return surface;
}

}  // namespace fourdvt::study
