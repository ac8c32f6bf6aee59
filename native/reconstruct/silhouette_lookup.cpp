// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/silhouette_lookup.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::reconstruct {
namespace {

constexpr double kDoubt_px = 2e-3;      // of projected points and of planes; what lies closer is asked exactly
constexpr double kNearestDepth = 1e-7;  // scaled; what lies before it is not seen
constexpr size_t kMostRows = 512;

// `across`: the cross product of the edge with the way from its beginning to the pixel.
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
  const auto line = [&](const glm::dvec3& weights) {  // of the camera frame's axes
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
  rows_.resize(std::clamp<size_t>(wedges.size() / 4, 1, kMostRows));
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
  bool background = false;  // even-odd rule: it changes at every edge to the right
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

// The point lies next to the edge. Whether beyond it, or beyond the corner at its nearer end, is known by the corner's
// two planes.
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
    // The line's part in the row, with a doubt on either side.
    const double y0 = std::max(p.y, top_px_ + r * row_px_ - kDoubt_px);
    const double y1 = std::min(q.y, top_px_ + (r + 1) * row_px_ + kDoubt_px);
    double x0 = p.x + slope * (y0 - p.y), x1 = p.x + slope * (y1 - p.y);
    if (y1 - y0 < kDoubt_px) x0 = p.x, x1 = q.x;  // hardly any: the slope may mean nothing
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
