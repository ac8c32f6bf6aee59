// SPDX-License-Identifier: Apache-2.0
#include "live/server/live_hull.h"

#include <algorithm>
#include <cmath>

#include "base/watch.h"
#include "reconstruct/hull_planes.h"
#include "reconstruct/polyhedral_hull.h"
#include "reconstruct/surface_cleaning.h"
#include "silhouette/contour.h"

namespace fourdvt::live {
namespace {

using silhouette::Ring, reconstruct::SilhouetteCone;

constexpr double kSpeck_m3 = 3e-6;         // same as in offline hulls
constexpr double kSecondTolerance_px = 2;  // tolerance of the second attempt
constexpr int kSmallWidth = 96;            // pixels
constexpr size_t kMinCarving = 2;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

bool cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

// True if edges of the rings cross; such an outline has no closed hull.
bool crosses(const std::vector<Ring>& rings) {
  struct Edge {
    glm::dvec2 from, to;
  };
  std::vector<Edge> edges;
  for (const Ring& ring : rings)
    for (size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t k = i + 1; k < edges.size(); ++k)
      if (cross(edges[i].from, edges[i].to, edges[k].from, edges[k].to)) return true;
  return false;
}

// Cones of a subset of a rig's cameras, and the attempts at a hull from them.
class Attempts {
 public:
  Attempts(const LiveHullRules& rules, std::vector<SilhouetteCone> cones, std::vector<size_t> cameras)
      : rules_(rules), cones_(std::move(cones)), cameras_(std::move(cameras)) {}

  Result<LiveHull> run() {
    if (tryOut(cones_)) return std::move(out_);
    for (SilhouetteCone& cone : cones_) silhouette::simplifyRings(cone.outline.rings, kSecondTolerance_px);
    if (inTime() && tryOut(cones_)) return std::move(out_);
    for (size_t k = cones_.size(); k-- > 0 && cones_.size() > kMinCarving;)
      if (crosses(cones_[k].outline.rings)) leaveOut(k);
    if (!out_.left_out.empty() && inTime() && tryOut(cones_)) return std::move(out_);
    for (size_t k = 0; k < cones_.size() && cones_.size() > kMinCarving && inTime(); ++k) {
      std::vector<SilhouetteCone> others = cones_;
      others.erase(others.begin() + long(k));
      if (!tryOut(others)) continue;
      out_.left_out.push_back(cameras_[k]);
      return std::move(out_);
    }
    return Error{ErrorId::Internal, "the outlines make no closed hull; check the cameras' mattes on the console"};
  }

 private:
  bool tryOut(const std::vector<SilhouetteCone>& cones) {
    ++attempts_;
    auto hull = reconstruct::polyhedralHull(cones, rules_.bounds);
    if (!hull.ok()) return false;
    out_.mesh = std::move(hull.value().mesh);
    out_.attempts = attempts_;
    return true;
  }

  void leaveOut(size_t k) {
    out_.left_out.push_back(cameras_[k]);
    cones_.erase(cones_.begin() + long(k));
    cameras_.erase(cameras_.begin() + long(k));
  }

  bool inTime() const { return watch_.ms() < rules_.max_ms; }

  const LiveHullRules& rules_;
  std::vector<SilhouetteCone> cones_;
  std::vector<size_t> cameras_;  // camera of each cone
  LiveHull out_;
  int attempts_ = 0;
  const Watch watch_;
};

}  // namespace

silhouette::Outline outlineFrom(const std::vector<Ring16>& rings) {
  silhouette::Outline out;
  for (const Ring16& ring : rings) {
    Ring& points = out.rings.emplace_back();
    for (const Point16& p : ring)
      if (const glm::dvec2 at = glm::dvec2(p.x, p.y) / kPointsPerPixel; points.empty() || at != points.back())
        points.push_back(at);
    while (points.size() > 1 && points.front() == points.back()) points.pop_back();
    if (points.size() < 3) out.rings.pop_back();
  }
  return out;
}

HullMaker::HullMaker(std::vector<PinholeCamera> cameras, const LiveHullRules& rules)
    : cameras_(std::move(cameras)), rules_(rules) {
  for (const PinholeCamera& camera : cameras_)
    small_cameras_.push_back(reducedCamera(camera, std::max(1, camera.width / kSmallWidth)));
}

Result<HullMaker> HullMaker::create(std::vector<PinholeCamera> cameras, const LiveHullRules& rules) {
  std::vector<SilhouetteCone> cones;
  for (const PinholeCamera& camera : cameras) cones.push_back({camera, {}});
  if (const auto planes = reconstruct::hullPlanes(cones, rules.bounds); !planes.ok())
    return Error{ErrorId::InvalidArgument, planes.error().message + "; correct \"bounds\" of the rig or its cameras"};
  return HullMaker(std::move(cameras), rules);
}

Result<LiveHull> HullMaker::make(std::span<const std::vector<Ring16>* const> rings) const {
  std::vector<SilhouetteCone> cones;
  std::vector<size_t> cameras;
  for (size_t c = 0; c < cameras_.size(); ++c) {
    if (!rings[c] || rings[c]->empty()) continue;
    SilhouetteCone cone{cameras_[c], outlineFrom(*rings[c])};
    if (cone.outline.rings.empty()) continue;
    cones.push_back(std::move(cone));
    cameras.push_back(c);
  }
  if (cones.size() < kMinCarving)
    return Error{ErrorId::NothingVisible, "fewer than two cameras have an outline; check them on the console"};
  std::vector<PinholeCamera> carving;
  for (const size_t c : cameras) carving.push_back(cameras_[c]);
  FOURDVT_ASSIGN(auto hull, Attempts(rules_, std::move(cones), std::move(cameras)).run());
  clean(carving, hull.mesh);
  return hull;
}

void HullMaker::clean(std::span<const PinholeCamera> carving, TriangleMesh& mesh) const {
  if (mesh.faces.empty()) return;
  reconstruct::dropUnseen(mesh, carving, std::max(kMinCarving, (carving.size() + 1) / 2));
  reconstruct::dropHollows(mesh);
  reconstruct::dropSpecks(mesh, kSpeck_m3);
  std::vector<silhouette::Silhouette> views;  // coverage is not needed
  for (const PinholeCamera& camera : small_cameras_) views.push_back({camera, {}});
  std::vector<const silhouette::Silhouette*> pointers;
  for (const auto& view : views) pointers.push_back(&view);
  reconstruct::dropNeedless(mesh, pointers, kSpeck_m3);
  reconstruct::simplify(mesh, rules_.max_triangles);
}

// Accumulates an edge's part within one row of pixels, from x0 to x1 and covering `height` of the row (negative:
// upwards), as the change of the area right of the edge.
void RingCoverage::addRow(int y, double x0, double x1, double height) {
  float* row = &area_[size_t(y) * (width_ + 1)];
  x0 = std::clamp(x0, 0.0, double(width_));
  x1 = std::clamp(x1, 0.0, double(width_));
  if (x0 > x1) std::swap(x0, x1);
  const int first = std::min(int(x0), width_), last = std::min(int(x1), width_);
  if (first == last) {
    const double right = first + 1 - (x0 + x1) / 2;
    row[first] += float(height * right);
    if (first < width_) row[first + 1] += float(height * (1 - right));
    return;
  }
  const double slope = height / (x1 - x0);
  double before = 0;  // area right of the edge within the pixels so far
  for (int x = first; x <= last; ++x) {
    const double from = std::max(x0, double(x)), to = std::min(x1, x + 1.0);
    const double passed = slope * (to - from), begun = slope * (from - x0);
    const double area = begun + passed * (x + 1 - (from + to) / 2);
    row[x] += float(area - before);
    before = area;
  }
  if (last < width_) row[last + 1] += float(height - before);
}

void RingCoverage::addEdge(double x0, double y0, double x1, double y1) {
  if (y0 == y1) return;
  const double sign = y0 < y1 ? 1 : -1;
  if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
  const double step = (x1 - x0) / (y1 - y0), end = std::min(y1, double(height_));
  for (double y = std::max(y0, 0.0); y < end;) {
    const int row = int(y);
    const double next = std::min(end, row + 1.0);
    addRow(row, x0 + (y - y0) * step, x0 + (next - y0) * step, sign * (next - y));
    y = next;
  }
}

const std::vector<float>& RingCoverage::draw(const std::vector<Ring16>& rings, const package::Rect& source,
                                             int stretched_width, int stretched_height, int width, int height) {
  width_ = width, height_ = height;
  area_.assign(size_t(width + 1) * height, 0);
  const double sx = double(stretched_width) / source.width, sy = double(stretched_height) / source.height;
  const auto x = [&](const Point16& p) { return (p.x / kPointsPerPixel - source.x) * sx; };
  const auto y = [&](const Point16& p) { return (p.y / kPointsPerPixel - source.y) * sy; };
  for (const Ring16& ring : rings)
    for (size_t i = 0; i < ring.size(); ++i) {
      const Point16 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      addEdge(x(a), y(a), x(b), y(b));
    }
  // Prefix sums along rows, without their spare column. Downward edges have the background on the left: negative.
  for (int row = 0; row < height; ++row) {
    const float* in = &area_[size_t(row) * (width + 1)];
    float* out = &area_[size_t(row) * width];
    float sum = 0;
    for (int k = 0; k < width; ++k) {
      sum += in[k];
      out[k] = std::clamp(std::abs(sum), 0.0f, 1.0f);
    }
  }
  area_.resize(size_t(width) * height);
  return area_;
}

}  // namespace fourdvt::live
