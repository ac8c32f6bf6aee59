// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/hull_planes.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "silhouette/contour.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kNearest = 1e-3;           // between a camera and the bounds, and between cameras; scaled
constexpr double kBoundsReach = 1e-4;       // how far from the bounds a wedge still counts as reaching them; scaled
constexpr uint32_t kMostPlanes = 1u << 21;  // three of their numbers fit into 64 bits

Error invalid(const std::string& message) { return {ErrorId::InvalidArgument, "polyhedral hull: " + message}; }

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// > 0: the ring turns towards the background.
double turn(const glm::dvec2& before, const glm::dvec2& at, const glm::dvec2& after) {
  const glm::dvec2 in = at - before, out = after - at;
  return in.x * out.y - in.y * out.x;
}

class Builder {
 public:
  Builder(const BoundingBox& bounds, const PlaneRounding& rounding) : random_(rounding.seed), rounding_(rounding) {
    const glm::dvec3 low(bounds.min), high(bounds.max);
    out_.centre_in_world = 0.5 * (low + high);
    const glm::dvec3 half_m = 0.5 * (high - low);
    out_.metres_per_unit = std::max({half_m.x, half_m.y, half_m.z});
    half_ = half_m / out_.metres_per_unit;
  }

  void addBounds() {
    for (int axis = 0; axis < 3; ++axis)
      for (double sign : {1.0, -1.0}) {
        glm::dvec3 normal(0);
        normal[axis] = sign;
        out_.planes.push_back({jiggled(normal, -half_[axis]), normal});
      }
  }

  Status addCamera(const SilhouetteCone& cone) {
    const glm::dvec3 centre = (cone.camera.centreInWorld() - out_.centre_in_world) / out_.metres_per_unit;
    if (!finite(centre)) return invalid("camera " + cone.camera.name + " has no finite place");
    if (glm::all(glm::lessThan(glm::abs(centre), half_ + kNearest)))
      return invalid("camera " + cone.camera.name + " lies within the bounds");
    for (const glm::dvec3& other : out_.centres)
      if (glm::length(other - centre) < kNearest)
        return invalid("camera " + cone.camera.name + " lies where another one is");
    out_.first.push_back(uint32_t(out_.planes.size()));
    out_.centres.push_back(centre);
    std::vector<silhouette::Ring> rings = cone.outline.rings;
    for (const silhouette::Ring& ring : rings)
      for (const glm::dvec2& p : ring)
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) return invalid("an outline has points that are not finite");
    silhouette::simplifyRings(rings, rounding_.least_turn_px);
    for (const silhouette::Ring& ring : rings) addRing(cone.camera, ring);
    return {};
  }

  Result<HullPlanes> finish() {
    out_.first.push_back(uint32_t(out_.planes.size()));
    if (out_.planes.size() >= kMostPlanes) return invalid("the outlines have too many points");
    for (const HullPlane& p : out_.planes)
      if (!finite(p.normal)) return invalid("a camera's pose or intrinsics are not finite");
    for (HullPlane& p : out_.planes) p.reaches_bounds = reachesBounds(p);
    return std::move(out_);
  }

 private:
  Plane jiggled(const glm::dvec3& normal, double offset) {
    std::uniform_real_distribution<double> some(-rounding_.jiggle, rounding_.jiggle);
    const double x = some(random_), y = some(random_), z = some(random_), d = some(random_);
    return Plane::rounded(normal + glm::dvec3(x, y, z), offset + d);
  }

  void addRing(const PinholeCamera& camera, const silhouette::Ring& ring) {
    if (ring.size() < 3) return;
    const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
    const auto ray = [&](const glm::dvec2& pixel) {
      return world_from_cam * glm::dvec3((pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy, 1);
    };
    const uint32_t first = uint32_t(out_.planes.size()), count = uint32_t(ring.size());
    for (uint32_t i = 0; i < count; ++i) {
      const uint32_t before = (i + count - 1) % count, after = (i + 1) % count;
      HullPlane wedge;
      wedge.camera = int(out_.centres.size()) - 1;
      wedge.from = ring[i];
      wedge.to = ring[after];
      wedge.from_ray = glm::normalize(ray(wedge.from));
      wedge.normal = glm::normalize(glm::cross(ray(wedge.from), ray(wedge.to)));
      wedge.plane = jiggled(wedge.normal, -glm::dot(wedge.normal, out_.centres.back()));
      wedge.previous = first + before;
      wedge.next = first + after;
      // The edge's other end lies behind the neighbour's plane where the ring turns away from the background.
      wedge.previous_side = turn(ring[before], ring[i], ring[after]) > 0 ? 1 : -1;
      wedge.next_side = turn(ring[i], ring[after], ring[(after + 1) % count]) > 0 ? 1 : -1;
      out_.planes.push_back(wedge);
    }
  }

  // Whether some of the bounds lies on the plane and on the wedge's sides of its neighbours.
  bool reachesBounds(const HullPlane& p) const {
    if (p.camera == kBounds) return true;
    const glm::dvec3& centre = out_.centres[p.camera];
    const auto reach = [&](const glm::dvec3& normal) { return glm::dot(glm::abs(normal), half_) + kBoundsReach; };
    const auto ahead = [&](uint32_t neighbour, int side) {
      const glm::dvec3& normal = out_.planes[neighbour].normal;
      return -side * glm::dot(normal, centre) + reach(normal) > 0;
    };
    return std::abs(glm::dot(p.normal, centre)) < reach(p.normal) && ahead(p.previous, p.previous_side) &&
           ahead(p.next, p.next_side);
  }

  HullPlanes out_;
  std::mt19937 random_;
  PlaneRounding rounding_;
  glm::dvec3 half_{1};  // scaled
};

}  // namespace

Result<HullPlanes> hullPlanes(std::span<const SilhouetteCone> cones, const BoundingBox& bounds,
                              const PlaneRounding& rounding) {
  if (cones.empty()) return invalid("no cameras");
  const glm::dvec3 low(bounds.min), high(bounds.max);
  if (!finite(low) || !finite(high) || !glm::all(glm::lessThan(low, high))) return invalid("the bounds are empty");
  Builder builder(bounds, rounding);
  builder.addBounds();
  for (const SilhouetteCone& cone : cones) FOURDVT_TRY(builder.addCamera(cone));
  return builder.finish();
}

}  // namespace fourdvt::reconstruct
