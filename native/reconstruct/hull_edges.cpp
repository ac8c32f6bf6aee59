// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/hull_edges.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/triangulate.h"
#include "reconstruct/hull_planes.h"

namespace fourdvt::reconstruct {
namespace {

// Intersection of a plane with the current line.
struct Cut {
  uint32_t plane = 0;
  PlanePoint point;
};

class EdgeFinder {
 public:
  EdgeFinder(const HullPlanes& planes, std::span<const SilhouetteCone> cones) : all_(planes), planes_(planes.planes) {
    for (size_t k = 0; k < cones.size(); ++k) lookups_.emplace_back(planes, int(k), cones[k].camera);
    for (size_t k = 0; k < cones.size(); ++k) order_.push_back(int(k));
  }

  std::optional<std::vector<HalfEdge>> run() {
    for (uint32_t p = 0; p < kBoundPlanes; ++p)
      for (uint32_t q = p / 2 * 2 + 2; q < kBoundPlanes; ++q) find(p, q);
    for (uint32_t w = kBoundPlanes; w < planes_.size(); ++w) {
      if (planes_[w].reaches_bounds || planes_[planes_[w].next].reaches_bounds) findViewing(w);
      if (!planes_[w].reaches_bounds) continue;
      for (uint32_t p = 0; p < kBoundPlanes; ++p) find(p, w);
    }
    const int cameras = int(lookups_.size());
    const auto pair = [this](uint32_t a, uint32_t b) {
      find(a, b);
      return !failed_;
    };
    for (int i = 0; i < cameras; ++i)
      for (int j = i + 1; j < cameras && !failed_; ++j) visitEpipolarPairs(all_, i, j, pair);
    if (failed_) return {};
    return std::move(edges_);
  }

 private:
  // Finds the edges on the line between planes of two cameras, or of the bounds.
  void find(uint32_t a, uint32_t b) {
    begin(a, b);
    for (uint32_t p : {a, b}) {
      const HullPlane& plane = planes_[p];
      if (plane.camera == kBounds) continue;
      if (!limit(plane.previous, plane.previous_side) || !limit(plane.next, plane.next_side)) return;
    }
    cutAndKeep(-1);
  }

  // Finds the edges on the viewing line between a wedge and the next one in its ring.
  void findViewing(uint32_t a) {
    const uint32_t b = planes_[a].next;
    begin(a, b);
    if (!limit(planes_[a].previous, planes_[a].previous_side) || !limit(planes_[b].next, planes_[b].next_side)) return;
    cutAndKeep(planes_[a].next_side);
  }

  void begin(uint32_t a, uint32_t b) {
    a_ = a;
    b_ = b;
    line_.emplace(planes_[a].plane, planes_[b].plane);
    start_.reset();
    end_.reset();
  }

  // Clips the line to one side of the plane. Returns false if nothing is left.
  bool limit(uint32_t plane, int side) {
    const Cut cut{plane, PlanePoint(*line_, planes_[plane].plane)};
    if (cut.point.heading() == 0) return tie();
    std::optional<Cut>& end = side == cut.point.heading() ? start_ : end_;
    if (!end || before(*end, cut) == (&end == &start_)) end = cut;
    return !failed_ && (!start_ || !end_ || before(*start_, *end_));
  }

  // True if one cut precedes another on the line.
  bool before(const Cut& one, const Cut& other) {
    if (one.plane == other.plane) return false;
    const int side = one.point.side(planes_[other.plane].plane);
    if (side == 0) tie();
    return side == -other.point.heading();
  }

  bool tie() {
    failed_ = true;
    return false;
  }

  // `face_side`: side of the line's second plane on which the first plane's face lies.
  void cutAndKeep(int face_side) {
    for (uint32_t p = 0; p < kBoundPlanes; ++p)
      if (p != a_ && p != b_ && !(p / 2 == a_ / 2 && a_ < kBoundPlanes) && !(p / 2 == b_ / 2 && b_ < kBoundPlanes) &&
          !limit(p, -1))
        return;
    outside_ = 0;
    cuts_.clear();
    const glm::dvec3 from = start_->point.position(), to = end_->point.position();
    for (size_t i = 0; i < order_.size(); ++i)
      if (order_[i] != planes_[a_].camera && order_[i] != planes_[b_].camera && !cutBy(order_[i], from, to)) {
        // Neighbouring lines are likely to be excluded by the same camera: it is tested earlier next time.
        std::swap(order_[i], order_[i / 2]);
        return;
      }
    std::sort(cuts_.begin(), cuts_.end(), [this](const Cut& one, const Cut& other) { return before(one, other); });
    if (!failed_) keep(face_side);
  }

  // Collects the cuts of the line by the camera's wedges. Returns false if it excludes the whole line.
  bool cutBy(int camera, const glm::dvec3& from, const glm::dvec3& to) {
    bool ties = false;
    const bool holds = lookups_[camera].mayHold(start_->point, from, ties);
    const size_t first_cut = cuts_.size();
    found_.clear();
    lookups_[camera].candidates(from, to, found_);
    for (uint32_t index : found_) {
      const HullPlane& wedge = planes_[index];
      const int at_start = start_->point.side(wedge.plane), at_end = end_->point.side(wedge.plane);
      ties |= at_start == 0 || at_end == 0;
      if (at_start == at_end) continue;
      const Cut cut{index, PlanePoint(*line_, wedge.plane)};
      const int previous = cut.point.side(planes_[wedge.previous].plane),
                next = cut.point.side(planes_[wedge.next].plane);
      ties |= previous == 0 || next == 0 || cut.point.heading() == 0;
      if (previous == wedge.previous_side && next == wedge.next_side) cuts_.push_back(cut);
    }
    if (ties) return tie();
    outside_ += !holds;
    return holds || cuts_.size() > first_cut;
  }

  // Emits the segments inside all cameras' silhouettes.
  void keep(int face_side) {
    uint32_t from = start_->plane;
    for (const Cut& cut : cuts_) {
      const bool leaving = cut.point.heading() > 0;
      if (leaving && outside_ == 0) emit(from, cut.plane, face_side);
      outside_ += leaving ? 1 : -1;
      from = cut.plane;
      if (outside_ < 0) failed_ = true;
    }
    if (outside_ == 0) emit(from, end_->plane, face_side);
  }

  void emit(uint32_t from_plane, uint32_t to_plane, int face_side) {
    VertexName from = vertexName(a_, b_, from_plane), to = vertexName(a_, b_, to_plane);
    // The first plane's face lies left of the line if that is inside the second plane.
    if (face_side > 0) std::swap(from, to);
    edges_.push_back({a_, from, to});
    edges_.push_back({b_, to, from});
  }

  const HullPlanes& all_;
  const std::vector<HullPlane>& planes_;
  std::vector<SilhouetteLookup> lookups_;
  std::vector<int> order_;  // cameras
  std::vector<HalfEdge> edges_;
  bool failed_ = false;

  // Current line.
  uint32_t a_ = 0, b_ = 0;
  std::optional<PlaneLine> line_;
  std::optional<Cut> start_, end_;
  std::vector<Cut> cuts_;
  std::vector<uint32_t> found_;
  int outside_ = 0;  // cameras
};

}  // namespace

std::optional<std::vector<HalfEdge>> hullEdges(const HullPlanes& planes, std::span<const SilhouetteCone> cones) {
  return EdgeFinder(planes, cones).run();
}

namespace {

constexpr uint32_t kNoPlace = ~0u;

struct NameHash {
  size_t operator()(VertexName name) const { return size_t((name ^ (name >> 31)) * 0x9E3779B97F4A7C15ull >> 7); }
};

class FaceLinker {
 public:
  FaceLinker(const HullPlanes& planes, std::vector<HalfEdge>& edges) : planes_(planes), edges_(edges) {}

  Result<TriangleMesh> run() {
    nameVertices();
    for (int count : edges_at_)
      if (count != 6) return open("a vertex has " + std::to_string(count) + " half edges in place of 6");
    std::stable_sort(edges_.begin(), edges_.end(),
                     [](const HalfEdge& a, const HalfEdge& b) { return a.plane < b.plane; });
    next_.assign(places_.size(), kNoPlace);
    for (size_t begin = 0, end = 0; begin < edges_.size(); begin = end) {
      while (end < edges_.size() && edges_[end].plane == edges_[begin].plane) ++end;
      FOURDVT_TRY(addFaces(std::span(edges_).subspan(begin, end - begin)));
    }
    for (const glm::dvec3& place : places_) mesh_.positions.emplace_back(planes_.inWorld(place));
    return std::move(mesh_);
  }

 private:
  static Error open(const std::string& what) {
    return {ErrorId::Internal, "polyhedral hull: the surface does not close: " + what};
  }

  void nameVertices() {
    numbers_.reserve(edges_.size() / 2);
    for (const HalfEdge& edge : edges_)
      for (VertexName name : {edge.from, edge.to}) {
        const auto [entry, added] = numbers_.try_emplace(name, uint32_t(places_.size()));
        if (added) {
          places_.push_back(placeOf(name));
          edges_at_.push_back(0);
        }
        ++edges_at_[entry->second];
      }
  }

  glm::dvec3 placeOf(VertexName name) const {
    const auto [a, b, c] = planesOf(name);
    const auto& p = planes_.planes;
    return PlanePoint(PlaneLine(p[a].plane, p[b].plane), p[c].plane).position();
  }

  // Triangulates the loops of one plane.
  Status addFaces(std::span<const HalfEdge> edges) {
    const glm::dvec3 normal = planes_.planes[edges[0].plane].normal;
    const glm::dvec3 axis = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 across = glm::normalize(glm::cross(axis, normal)), up = glm::cross(normal, across);
    for (const HalfEdge& edge : edges) {
      uint32_t& next = next_[numbers_.at(edge.from)];
      if (next != kNoPlace) return open("two edges of a face leave a vertex");
      next = numbers_.at(edge.to);
    }
    std::vector<FlatLoop> loops;
    for (const HalfEdge& edge : edges) {
      const uint32_t first = numbers_.at(edge.from);
      if (next_[first] == kNoPlace) continue;  // already in a loop
      FlatLoop loop;
      uint32_t at = first;
      do {
        loop.push_back({{glm::dot(places_[at], across), glm::dot(places_[at], up)}, at});
        at = std::exchange(next_[at], kNoPlace);
      } while (at != first && at != kNoPlace);
      if (at == kNoPlace || loop.size() < 3) return open("edges of a face make no loop");
      loops.push_back(std::move(loop));
    }
    triangulate(std::move(loops), mesh_.faces);
    return {};
  }

  const HullPlanes& planes_;
  std::vector<HalfEdge>& edges_;
  std::unordered_map<VertexName, uint32_t, NameHash> numbers_;
  std::vector<glm::dvec3> places_;  // [vertex] scaled
  std::vector<int> edges_at_;       // [vertex] half edges that begin or end there
  std::vector<uint32_t> next_;      // [vertex] successor on the current face
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> hullFaces(const HullPlanes& planes, std::vector<HalfEdge>& edges) {
  return FaceLinker(planes, edges).run();
}

namespace {

constexpr double kDoubt_px = 2e-3;      // projected points and planes closer than this use exact predicates
constexpr double kNearestDepth = 1e-7;  // scaled; closer points are invisible
constexpr size_t kMaxRows = 512;

// `across`: cross product of the edge with the vector from its beginning to the pixel.
bool nearLine(const HullPlane& wedge, const glm::dvec2& pixel, double across) {
  const glm::dvec2 along = wedge.to - wedge.from;
  return across * across < kDoubt_px * kDoubt_px * glm::dot(along, along) &&
         glm::all(glm::lessThan(glm::min(wedge.from, wedge.to) - kDoubt_px, pixel)) &&
         glm::all(glm::lessThan(pixel, glm::max(wedge.from, wedge.to) + kDoubt_px));
}

}  // namespace

SilhouetteLookup::SilhouetteLookup(const HullPlanes& planes, int camera, const PinholeCamera& pinhole)
    : planes_(planes), first_(planes.first[camera]) {
  const glm::dmat3 rotation(pinhole.cam_from_world);
  const glm::dvec3 moved = -(rotation * planes.centres[camera]);
  const auto line = [&](const glm::dvec3& weights) {  // weighted by the camera frame's axes
    return glm::dvec4(weights * rotation, glm::dot(weights, moved));
  };
  picture_from_scaled_ = glm::transpose(glm::dmat4(line({pinhole.fx, 0, pinhole.cx}), line({0, pinhole.fy, pinhole.cy}),
                                                   line({0, 0, 1}), glm::dvec4(0, 0, 0, 1)));
  const auto wedges = planes.ofCamera(camera);
  stamp_.assign(wedges.size(), 0);
  if (wedges.empty()) return;
  top_px_ = bottom_px_ = wedges[0].from.y;
  for (const HullPlane& wedge : wedges) {
    top_px_ = std::min(top_px_, wedge.from.y);
    bottom_px_ = std::max(bottom_px_, wedge.from.y);
  }
  rows_.resize(std::clamp<size_t>(wedges.size() / 4, 1, kMaxRows));
  row_px_ = std::max((bottom_px_ - top_px_) / double(rows_.size()), 1e-9);
  for (uint32_t i = 0; i < wedges.size(); ++i) {
    const auto [from_y, to_y] = std::minmax(wedges[i].from.y, wedges[i].to.y);
    const int low = row(from_y - kDoubt_px), high = row(to_y + kDoubt_px);
    const auto [left, right] = std::minmax(wedges[i].from.x, wedges[i].to.x);
    for (int r = low; r <= high; ++r) rows_[r].push_back({left, right, first_ + i});
  }
}

int SilhouetteLookup::row(double y_px) const {
  return int(std::clamp((y_px - top_px_) / row_px_, 0.0, double(rows_.size() - 1)));
}

bool SilhouetteLookup::mayHold(const PlanePoint& point, const glm::dvec3& scaled, bool& tie) const {
  if (rows_.empty()) return true;
  const glm::dvec4 seen = picture_from_scaled_ * glm::dvec4(scaled, 1);
  if (seen.z < kNearestDepth) return true;
  const glm::dvec2 pixel = glm::dvec2(seen) / seen.z;
  if (pixel.y < top_px_ - kDoubt_px || pixel.y > bottom_px_ + kDoubt_px) return true;
  bool background = false;  // even-odd rule: toggles at every edge to the right
  for (const RowEdge& edge : rows_[row(pixel.y)]) {
    if (pixel.x > edge.right_px + kDoubt_px) continue;
    const HullPlane& wedge = planes_.planes[edge.plane];
    const glm::dvec2 &from = wedge.from, &to = wedge.to, along = to - from, away = pixel - from;
    const double across = along.x * away.y - along.y * away.x;
    if (nearLine(wedge, pixel, across)) return mayHoldNear(edge.plane, pixel, point, tie);
    if ((from.y > pixel.y) != (to.y > pixel.y) && (across > 0) == (along.y > 0)) background = !background;
  }
  return !background;
}

// Point close to the edge: two planes of the corner at the nearer end determine exactly if it lies beyond the edge or
// the corner.
bool SilhouetteLookup::mayHoldNear(uint32_t edge, const glm::dvec2& pixel, const PlanePoint& point, bool& tie) const {
  const HullPlane& wedge = planes_.planes[edge];
  const bool at_start = glm::distance(pixel, wedge.from) < glm::distance(pixel, wedge.to);
  const uint32_t before = at_start ? wedge.previous : edge, after = at_start ? edge : wedge.next;
  const int side_before = point.side(planes_.planes[before].plane),
            side_after = point.side(planes_.planes[after].plane);
  tie |= side_before == 0 || side_after == 0;
  const bool towards_background = planes_.planes[after].previous_side > 0;
  return towards_background ? side_before < 0 || side_after < 0 : side_before < 0 && side_after < 0;
}

void SilhouetteLookup::candidates(const glm::dvec3& from, const glm::dvec3& to, std::vector<uint32_t>& found) {
  if (rows_.empty()) return;
  glm::dvec4 a = picture_from_scaled_ * glm::dvec4(from, 1), b = picture_from_scaled_ * glm::dvec4(to, 1);
  if (a.z < kNearestDepth && b.z < kNearestDepth) return;
  if (a.z < kNearestDepth) a = glm::mix(b, a, (b.z - kNearestDepth) / (b.z - a.z));
  if (b.z < kNearestDepth) b = glm::mix(a, b, (a.z - kNearestDepth) / (a.z - b.z));
  glm::dvec2 p = glm::dvec2(a) / a.z, q = glm::dvec2(b) / b.z;
  if (p.y > q.y) std::swap(p, q);
  if (q.y < top_px_ - kDoubt_px || p.y > bottom_px_ + kDoubt_px) return;
  ++question_;
  const double slope = q.y > p.y ? (q.x - p.x) / (q.y - p.y) : 0;
  const int last = row(q.y + kDoubt_px);
  for (int r = row(p.y - kDoubt_px); r <= last; ++r) {
    // Part of the line in the row, extended by the tolerance on either side.
    const double y0 = std::max(p.y, top_px_ + r * row_px_ - kDoubt_px);
    const double y1 = std::min(q.y, top_px_ + (r + 1) * row_px_ + kDoubt_px);
    double x0 = p.x + slope * (y0 - p.y), x1 = p.x + slope * (y1 - p.y);
    if (y1 - y0 < kDoubt_px) x0 = p.x, x1 = q.x;  // nearly horizontal: the slope is unreliable
    if (x0 > x1) std::swap(x0, x1);
    for (const RowEdge& edge : rows_[r]) {
      if (edge.right_px < x0 - kDoubt_px || edge.left_px > x1 + kDoubt_px) continue;
      uint32_t& stamp = stamp_[edge.plane - first_];
      if (stamp == question_) continue;
      stamp = question_;
      found.push_back(edge.plane);
    }
  }
}

}  // namespace fourdvt::reconstruct
