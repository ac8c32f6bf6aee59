// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/hull_planes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "silhouette/contour.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kNearest = 1e-3;      // minimum distance between a camera and the bounds, and between cameras; scaled
constexpr double kBoundsReach = 1e-4;  // tolerance of the test that a wedge reaches the bounds; scaled
constexpr uint32_t kMaxPlanes = 1u << 21;  // three indices fit into 64 bits

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
    silhouette::simplifyRings(rings, rounding_.min_turn_px);
    for (const silhouette::Ring& ring : rings) addRing(cone.camera, ring);
    return {};
  }

  Result<HullPlanes> finish() {
    out_.first.push_back(uint32_t(out_.planes.size()));
    if (out_.planes.size() >= kMaxPlanes) return invalid("the outlines have too many points");
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

  // True if the plane intersects the bounds on the wedge's sides of its neighbours.
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

namespace {

__extension__ typedef __int128 Int128;

constexpr double kUnitBits = 27, kMaxBits = 29;
// Rounding errors of doubles, for coefficients up to M = 2^29 and half a unit in the last place u = 2^-53: at most 4uM²
// for a minor of two rows, 30uM³ for one of three rows, and 216uM⁴ for the determinant.
const double kDoubt3 = std::ldexp(32.0, int(3 * kMaxBits) - 53);
const double kDoubt4 = std::ldexp(256.0, int(4 * kMaxBits) - 53);
// Minimum weight for positions from doubles: their error is then below 2^-34.
const double kClearWeight = std::ldexp(1.0, int(3 * kMaxBits) - 16);

int signOf(Int128 value) { return (value > 0) - (value < 0); }

// Determinants of three rows without column 0, 1, 2 and 3, signed such that their dot product with a fourth row is the
// determinant of all four.
std::array<Int128, 4> exactPoint(const std::array<const Plane*, 3>& planes) {
  int64_t a[4], b[4], c[4];
  for (int i = 0; i < 4; ++i) {
    a[i] = int64_t(planes[0]->coefficients[i]);
    b[i] = int64_t(planes[1]->coefficients[i]);
    c[i] = int64_t(planes[2]->coefficients[i]);
  }
  const auto minor = [&](int i, int j) { return Int128(a[i] * b[j] - a[j] * b[i]); };
  const Int128 m01 = minor(0, 1), m02 = minor(0, 2), m03 = minor(0, 3), m12 = minor(1, 2), m13 = minor(1, 3),
               m23 = minor(2, 3);
  return {-(c[1] * m23 - c[2] * m13 + c[3] * m12), c[0] * m23 - c[2] * m03 + c[3] * m02,
          -(c[0] * m13 - c[1] * m03 + c[3] * m01), c[0] * m12 - c[1] * m02 + c[2] * m01};
}

}  // namespace

Plane Plane::rounded(const glm::dvec3& normal, double offset) {
  const double scale = std::min(std::ldexp(1.0, int(kUnitBits)), std::ldexp(1.0, int(kMaxBits)) / std::abs(offset));
  return {{std::round(normal.x * scale), std::round(normal.y * scale), std::round(normal.z * scale),
           std::round(offset * scale)}};
}

PlaneLine::PlaneLine(const Plane& first_plane, const Plane& second_plane) : first(&first_plane), second(&second_plane) {
  const auto &a = first->coefficients, &b = second->coefficients;
  m01 = a[0] * b[1] - a[1] * b[0];
  m02 = a[0] * b[2] - a[2] * b[0];
  m03 = a[0] * b[3] - a[3] * b[0];
  m12 = a[1] * b[2] - a[2] * b[1];
  m13 = a[1] * b[3] - a[3] * b[1];
  m23 = a[2] * b[3] - a[3] * b[2];
}

PlanePoint::PlanePoint(const PlaneLine& line, const Plane& third) : planes_{line.first, line.second, &third} {
  const auto& c = third.coefficients;
  homogeneous_ = {
      -(c[1] * line.m23 - c[2] * line.m13 + c[3] * line.m12), c[0] * line.m23 - c[2] * line.m03 + c[3] * line.m02,
      -(c[0] * line.m13 - c[1] * line.m03 + c[3] * line.m01), c[0] * line.m12 - c[1] * line.m02 + c[2] * line.m01};
  const double weight = homogeneous_[3];
  heading_ = std::abs(weight) > kDoubt3 ? (weight > 0 ? 1 : -1) : signOf(exactPoint(planes_)[3]);
}

int PlanePoint::side(const Plane& other) const {
  const auto& d = other.coefficients;
  const auto& x = homogeneous_;
  const double determinant = x[0] * d[0] + x[1] * d[1] + x[2] * d[2] + x[3] * d[3];
  if (std::abs(determinant) > kDoubt4) return determinant > 0 ? heading_ : -heading_;
  const std::array<Int128, 4> exact = exactPoint(planes_);
  Int128 sum = 0;
  for (int i = 0; i < 4; ++i) sum += exact[i] * Int128(int64_t(d[i]));
  return signOf(sum) * heading_;
}

glm::dvec3 PlanePoint::position() const {
  const auto& x = homogeneous_;
  if (std::abs(x[3]) > kClearWeight) return glm::dvec3(x[0], x[1], x[2]) / x[3];
  const std::array<Int128, 4> exact = exactPoint(planes_);
  return glm::dvec3(double(exact[0]), double(exact[1]), double(exact[2])) / double(exact[3]);
}

namespace {

constexpr double kTurn = 2 * std::numbers::pi;  // rad
constexpr double kDoubt = 1e-5;                 // rad, tolerance of a wedge's angles on either side
constexpr double kDoubtShare =
    0.1;  // tolerance as a share of the wedge's angle: flat corners move when planes are rounded
constexpr double kMinSine = 1e-3;  // between viewing line and baseline; below, the angle is unreliable

struct Pencil {
  glm::dvec3 across, up;  // unit, perpendicular to the baseline

  explicit Pencil(const glm::dvec3& baseline) {
    const glm::dvec3 along = glm::normalize(baseline), size = glm::abs(along);
    const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                            : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                 : glm::dvec3(0, 0, 1);
    across = glm::normalize(glm::cross(along, axis));
    up = glm::cross(along, across);
  }
};

// Angles of a wedge in steps of the circle, `first` … `first + count - 1`, modulo `steps`.
struct Span {
  int first = 0, count = 0;
};

Span spanOf(const Pencil& pencil, const glm::dvec3& from, const glm::dvec3& to, int steps) {
  const glm::dvec2 a(glm::dot(from, pencil.across), glm::dot(from, pencil.up));
  const glm::dvec2 b(glm::dot(to, pencil.across), glm::dot(to, pencil.up));
  const double start = std::atan2(a.y, a.x), swept = std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
  const bool unclear = glm::length(a) < kMinSine || glm::length(b) < kMinSine;
  if (unclear || std::abs(swept) > kTurn / 2 - kMinSine) return {0, steps};
  const double doubt = kDoubt + kDoubtShare * std::abs(swept), middle = start + swept / 2 + 2 * kTurn;
  const double low = middle - std::abs(swept) / 2 - doubt, high = middle + std::abs(swept) / 2 + doubt;
  const int first = int(std::floor(low / kTurn * steps)), last = int(std::floor(high / kTurn * steps));
  return {first, std::min(last - first + 1, steps)};
}

}  // namespace

void visitEpipolarPairs(const HullPlanes& planes, int first, int second,
                        const std::function<bool(uint32_t, uint32_t)>& visit) {
  const Pencil pencil(planes.centres[second] - planes.centres[first]);
  const auto ours = planes.ofCamera(first), theirs = planes.ofCamera(second);
  const int steps = std::clamp(int(2 * theirs.size()), 16, 8192);
  const auto span = [&](const HullPlane& wedge) {
    return spanOf(pencil, wedge.from_ray, planes.planes[wedge.next].from_ray, steps);
  };
  std::vector<std::vector<uint32_t>> buckets(steps);
  for (uint32_t i = 0; i < theirs.size(); ++i) {
    if (!theirs[i].reaches_bounds) continue;
    const Span s = span(theirs[i]);
    for (int k = 0; k < s.count; ++k) buckets[(s.first + k) % steps].push_back(i);
  }
  std::vector<uint32_t> seen_by(theirs.size(), ~0u);
  for (uint32_t e = 0; e < ours.size(); ++e) {
    if (!ours[e].reaches_bounds) continue;
    const Span s = span(ours[e]);
    for (int k = 0; k < s.count; ++k)
      for (uint32_t f : buckets[(s.first + k) % steps]) {
        if (seen_by[f] == e) continue;
        seen_by[f] = e;
        if (!visit(planes.first[first] + e, planes.first[second] + f)) return;
      }
  }
}

}  // namespace fourdvt::reconstruct
