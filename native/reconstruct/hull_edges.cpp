// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/hull_edges.h"

#include "reconstruct/epipolar_pairs.h"
#include "reconstruct/silhouette_lookup.h"

namespace fourdvt::reconstruct {
namespace {

// Where a plane cuts the line at hand.
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
  // The line between planes of two cameras, or of the bounds.
  void find(uint32_t a, uint32_t b) {
    begin(a, b);
    for (uint32_t p : {a, b}) {
      const HullPlane& plane = planes_[p];
      if (plane.camera == kBounds) continue;
      if (!limit(plane.previous, plane.previous_side) || !limit(plane.next, plane.next_side)) return;
    }
    cutAndKeep(-1);
  }

  // The viewing line between a wedge and the next one in its ring.
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

  // Cuts off what does not lie on that side of the plane. Returns false if nothing is left.
  bool limit(uint32_t plane, int side) {
    const Cut cut{plane, PlanePoint(*line_, planes_[plane].plane)};
    if (cut.point.heading() == 0) return tie();
    std::optional<Cut>& end = side == cut.point.heading() ? start_ : end_;
    if (!end || before(*end, cut) == (&end == &start_)) end = cut;
    return !failed_ && (!start_ || !end_ || before(*start_, *end_));
  }

  // Whether one cut comes before another on the line.
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

  // `face_side`: the side of the line's second plane on which the face in its first one lies.
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
        // Neighbouring lines, which come next, are likely to lose against the same camera.
        std::swap(order_[i], order_[i / 2]);
        return;
      }
    std::sort(cuts_.begin(), cuts_.end(), [this](const Cut& one, const Cut& other) { return before(one, other); });
    if (!failed_) keep(face_side);
  }

  // Collects where the camera's wedges cut the line. Returns false if it lets none of the line stand.
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

  // Emits the pieces that lie outside of no camera's silhouette.
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
    // The first plane's face lies on the line's left if that is the second plane's inside.
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

  // The line at hand.
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

}  // namespace fourdvt::reconstruct
