// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/glue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

namespace fourdvt::track {
namespace {

constexpr int kFirstRounds = 12, kGlueRounds = 10, kStraightenRounds = 6, kLastRounds = 40;
constexpr int kStraightenings = 3;
constexpr double kMinBenefit = 0.15;   // length of a seam against the smaller chart's border, for no narrow necks
constexpr double kWorthMoving = 0.98;  // most cost of a seam that replaces one of cost 1

// A chain of seam edges between two charts.
struct Arc {
  double benefit = 0;
  uint32_t left = 0, right = 0;      // charts
  std::vector<uint32_t> half_edges;  // vertices in the order of the left chart's border
  bool operator<(const Arc& o) const {
    return std::tie(benefit, o.left, o.right, o.half_edges) < std::tie(o.benefit, left, right, half_edges);
  }
};

class Glue {
 public:
  Glue(const Surface& surface, const GlueLimits& limits)
      : s_(surface), limits_(limits), glued_(s_.twins.size(), 0), chart_of_(s_.faceCount(), 0) {
    for (const double area : s_.areas) total_area_ += area;
  }

  void start(std::vector<FaceSet> sets) {
    std::reverse(sets.begin(), sets.end());
    while (!sets.empty()) {
      FaceSet set = std::move(sets.back());
      sets.pop_back();
      Patch patch = joined(set);
      if (set.size() == 1 || (patch.disk && liesFlat(patch))) {
        add(std::move(patch));
        continue;
      }
      for (const uint32_t f : set)
        for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) glued_[h] = 0;
      for (FaceSet& half : halves(s_, set)) sets.push_back(std::move(half));
    }
  }

  void run() {
    std::priority_queue<Arc> queue;
    for (uint32_t c = 0; c < charts_.size(); ++c)
      for (Arc& arc : arcsOf(c, true)) queue.push(std::move(arc));
    while (!queue.empty()) {
      const Arc arc = queue.top();
      queue.pop();
      if (charts_[arc.left].faces.empty() || charts_[arc.right].faces.empty() || !tryGlue(arc)) continue;
      for (Arc& next : arcsOf(uint32_t(charts_.size()) - 1, false)) queue.push(std::move(next));
    }
  }

  // Moves faces with two sides on a neighbouring chart to it where that shortens the seam, as long as both charts stay
  // within the limits.
  void straighten() {
    for (int round = 0; round < kStraightenings; ++round)
      for (uint32_t a = 0; a < charts_.size(); ++a) {
        std::vector<uint32_t> others;
        for (const uint32_t h : charts_[a].border)
          if (chartAcross(h) > a) others.push_back(chartAcross(h));
        std::sort(others.begin(), others.end());
        others.erase(std::unique(others.begin(), others.end()), others.end());
        for (const uint32_t b : others) straightenBetween(a, b);
      }
  }

  std::vector<Patch> take() {
    std::vector<Patch> out;
    for (Patch& chart : charts_) {
      if (chart.faces.empty()) continue;
      Patch polished = chart;
      flattenRigidly(s_, polished, kLastRounds);
      const Stretch before = stretchOf(s_, chart), after = stretchOf(s_, polished);
      const bool better = !after.folded && after.l2 <= before.l2 &&
                          after.max <= std::max(before.max, limits_.stretch_max) &&
                          !borderMeetsItself(s_, polished, limits_.gap_m);
      out.push_back(better ? std::move(polished) : std::move(chart));
    }
    return out;
  }

 private:
  Patch joined(const FaceSet& set) {
    std::vector<uint8_t> inside(s_.faceCount(), 0);
    for (const uint32_t f : set) inside[f] = 1;
    for (const uint32_t f : set)
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) glued_[h] = inside[s_.faceAcross(h)];
    return patchOf(s_, set, glued_);
  }

  bool liesFlat(Patch& patch) const {
    startOnCircle(s_, patch);
    flattenRigidly(s_, patch, kFirstRounds);
    return fits(patch);
  }

  bool fits(const Patch& patch) const {
    const Stretch stretch = stretchOf(s_, patch);
    return !stretch.folded && stretch.max <= limits_.stretch_max && stretch.l2 <= limits_.stretch_l2 &&
           !borderMeetsItself(s_, patch, limits_.gap_m);
  }

  void add(Patch patch) {
    if (patch.flat.empty()) startOnCircle(s_, patch), flattenRigidly(s_, patch, kFirstRounds);
    double area = 0, wanted = 0, border = 0;
    for (const uint32_t f : patch.faces) {
      chart_of_[f] = uint32_t(charts_.size());
      area += s_.areas[f];
      wanted += s_.areas[f] * s_.resolution[f];
    }
    for (const uint32_t h : patch.border) border += s_.length(h);
    areas_.push_back(area);
    borders_.push_back(border);
    resolutions_.push_back(area > 0 ? wanted / area : 1);
    charts_.push_back(std::move(patch));
  }

  uint32_t chartAcross(uint32_t half_edge) const { return chart_of_[s_.faceAcross(half_edge)]; }

  bool continues(uint32_t half_edge, uint32_t following) const {
    return chartAcross(half_edge) == chartAcross(following) &&
           nextOnBorder(s_, glued_, s_.twins[following]) == s_.twins[half_edge];
  }

  // Seams of a chart; `later_only`: with charts of higher numbers.
  std::vector<Arc> arcsOf(uint32_t chart, bool later_only) const {
    const std::vector<uint32_t>& border = charts_[chart].border;
    size_t first = 0;
    while (first < border.size() && continues(border[(first + border.size() - 1) % border.size()], border[first]))
      ++first;
    std::vector<Arc> arcs;
    if (first == border.size()) return arcs;  // one chart all round
    for (size_t i = 0; i < border.size(); ++i) {
      const uint32_t h = border[(first + i) % border.size()];
      const uint32_t previous = border[(first + i + border.size() - 1) % border.size()];
      if (i == 0 || !continues(previous, h)) arcs.push_back({0, chart, chartAcross(h), {}});
      arcs.back().half_edges.push_back(h);
    }
    std::erase_if(arcs, [&](Arc& arc) { return !weigh(arc) || (later_only && arc.right < chart); });
    return arcs;
  }

  // Returns false for charts that are not to be joined.
  bool weigh(Arc& arc) const {
    if (arc.left == arc.right || areas_[arc.left] + areas_[arc.right] > limits_.area_share * total_area_) return false;
    const double a = resolutions_[arc.left], b = resolutions_[arc.right];
    if (std::max(a, b) > limits_.resolution_ratio * std::min(a, b)) return false;
    for (const uint32_t h : arc.half_edges) arc.benefit += s_.length(h) * s_.seam_costs[h];
    arc.benefit /= std::min(borders_[arc.left], borders_[arc.right]);
    return arc.benefit >= kMinBenefit;
  }

  bool tryGlue(const Arc& arc) {
    for (const uint32_t h : arc.half_edges) glued_[h] = glued_[s_.twins[h]] = 1;
    Patch &left = charts_[arc.left], &right = charts_[arc.right];
    FaceSet faces = left.faces;
    faces.insert(faces.end(), right.faces.begin(), right.faces.end());
    Patch patch = patchOf(s_, std::move(faces), glued_);
    if (patch.disk) {
      align(arc, patch);
      flattenRigidly(s_, patch, kGlueRounds);
    }
    if (!patch.disk || !fits(patch)) {
      for (const uint32_t h : arc.half_edges) glued_[h] = glued_[s_.twins[h]] = 0;
      return false;
    }
    left = right = Patch{};
    add(std::move(patch));
    return true;
  }

  // A face moved to another chart, with the half-edge that was glued before.
  struct Move {
    uint32_t half_edge, from;
  };

  void straightenBetween(uint32_t a, uint32_t b) {
    std::vector<Move> moves;
    FaceSet open;
    for (const uint32_t c : {a, b})
      for (const uint32_t h : charts_[c].border) open.push_back(h / 3);
    for (size_t i = 0; i < open.size(); ++i) {
      const uint32_t f = open[i], own = chart_of_[f];
      if ((own != a && own != b) || !moveEar(f, own == a ? b : a, moves)) continue;
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) open.push_back(s_.faceAcross(h));
    }
    if (moves.empty()) return;
    std::array<Patch, 2> changed = {rejoined(a, moves), rejoined(b, moves)};
    if (fitsAgain(changed[0]) && fitsAgain(changed[1])) {
      charts_[a] = std::move(changed[0]);
      charts_[b] = std::move(changed[1]);
      return;
    }
    for (; !moves.empty(); moves.pop_back()) {
      setEar(moves.back().half_edge, true);
      chart_of_[moves.back().half_edge / 3] = moves.back().from;
    }
  }

  // Moves a face to chart `to` if one side is glued and the others follow each other on that chart's border.
  bool moveEar(uint32_t f, uint32_t to, std::vector<Move>& moves) {
    for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const uint32_t first = Surface::next(h), second = Surface::previous(h);
      if (!glued_[h] || glued_[first] || glued_[second] || chartAcross(first) != to || !continues(first, second))
        continue;
      const auto cost = [&](uint32_t side) { return s_.length(side) * s_.seam_costs[side]; };
      if (cost(h) > kWorthMoving * (cost(first) + cost(second))) return false;
      moves.push_back({h, chart_of_[f]});
      setEar(h, false);
      chart_of_[f] = to;
      return true;
    }
    return false;
  }

  // Glues `half_edge` and opens its face's other sides, or the other way round.
  void setEar(uint32_t half_edge, bool glued) {
    for (uint32_t h = 3 * (half_edge / 3), end = h + 3; h < end; ++h)
      glued_[h] = glued_[s_.twins[h]] = (h == half_edge) == glued;
  }

  // A chart after moves; texture vertices keep their places.
  Patch rejoined(uint32_t chart, const std::vector<Move>& moves) const {
    const Patch& before = charts_[chart];
    FaceSet faces, joining;
    std::vector<size_t> places;  // in `before`, of the first faces
    for (size_t i = 0; i < before.faces.size(); ++i)
      if (chart_of_[before.faces[i]] == chart) faces.push_back(before.faces[i]), places.push_back(i);
    for (const Move& move : moves)
      if (chart_of_[move.half_edge / 3] == chart && move.from != chart) joining.push_back(move.half_edge / 3);
    std::sort(joining.begin(), joining.end());
    joining.erase(std::unique(joining.begin(), joining.end()), joining.end());
    std::erase_if(joining, [&](uint32_t f) { return std::find(faces.begin(), faces.end(), f) != faces.end(); });
    faces.insert(faces.end(), joining.begin(), joining.end());
    Patch patch = patchOf(s_, std::move(faces), glued_);
    patch.flat.assign(patch.vertices.size(), glm::dvec2(std::numeric_limits<double>::quiet_NaN()));
    for (size_t i = 0; i < places.size(); ++i)
      for (int k = 0; k < 3; ++k) patch.flat[patch.corners[i][k]] = before.flat[before.corners[places[i]][k]];
    return patch;
  }

  bool fitsAgain(Patch& patch) const {
    if (!patch.disk || std::any_of(patch.flat.begin(), patch.flat.end(), [](const auto& p) { return std::isnan(p.x); }))
      return false;
    flattenRigidly(s_, patch, kStraightenRounds);
    return fits(patch);
  }

  glm::dvec2 flatAt(const Patch& patch, uint32_t half_edge) const {
    const size_t i = size_t(std::find(patch.faces.begin(), patch.faces.end(), half_edge / 3) - patch.faces.begin());
    return patch.flat[patch.corners[i][int(half_edge % 3)]];
  }

  // Starts `patch` from the left chart and the right chart moved to it, so that the arc's two sides meet.
  void align(const Arc& arc, Patch& patch) const {
    const Patch &left = charts_[arc.left], &right = charts_[arc.right];
    std::vector<std::pair<glm::dvec2, glm::dvec2>> pairs;
    for (const uint32_t h : arc.half_edges) {
      const uint32_t twin = s_.twins[h];
      pairs.emplace_back(flatAt(left, h), flatAt(right, Surface::next(twin)));
      pairs.emplace_back(flatAt(left, Surface::next(h)), flatAt(right, twin));
    }
    glm::dvec2 to(0), from(0), turn(0);
    for (const auto& [p, q] : pairs) to += p / double(pairs.size()), from += q / double(pairs.size());
    for (const auto& [p, q] : pairs) {
      const glm::dvec2 a = q - from, b = p - to;
      turn += glm::dvec2(glm::dot(a, b), a.x * b.y - a.y * b.x);
    }
    turn = glm::length(turn) > 0 ? glm::normalize(turn) : glm::dvec2(1, 0);
    patch.flat.assign(patch.vertices.size(), glm::dvec2(0));
    std::vector<int> sums(patch.vertices.size(), 0);
    for (size_t i = 0; i < patch.faces.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const bool from_left = i < left.faces.size();
        const glm::dvec2 p =
            from_left ? left.flat[left.corners[i][k]] : right.flat[right.corners[i - left.faces.size()][k]] - from;
        const uint32_t v = patch.corners[i][k];
        patch.flat[v] += from_left ? p : to + glm::dvec2(turn.x * p.x - turn.y * p.y, turn.y * p.x + turn.x * p.y);
        ++sums[v];
      }
    for (size_t v = 0; v < sums.size(); ++v) patch.flat[v] /= double(sums[v]);
  }

  const Surface& s_;
  const GlueLimits limits_;
  std::vector<uint8_t> glued_;                         // [half-edge]
  std::vector<uint32_t> chart_of_;                     // [face]
  std::vector<Patch> charts_;                          // without faces once glued to another
  std::vector<double> areas_, borders_, resolutions_;  // [chart] square metres, metres, relative
  double total_area_ = 0;
};

}  // namespace

std::vector<Patch> gluedCharts(const Surface& surface, std::vector<FaceSet> sets, const GlueLimits& limits) {
  Glue glue(surface, limits);
  glue.start(std::move(sets));
  glue.run();
  glue.straighten();
  return glue.take();
}

}  // namespace fourdvt::track
