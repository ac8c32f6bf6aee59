// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/labelling.h"

#include <algorithm>
#include <bit>
#include <map>
#include <mutex>
#include <span>

#include "bake/labels/expansion.h"
#include "bake/labels/schedule.h"
#include "base/watch.h"
#include "package/character.h"

namespace fourdvt::bake {
namespace {

std::string complaint(const LabelOptions& o) {
  if (o.layers < 1 || o.layers > package::kMaxLayers) return "layers must be 1 to 6";
  if (o.window_frames < 1 || o.hop_frames < 1 || o.hop_frames > o.window_frames)
    return "a window holds at least one frame, and the hop is 1 to the window";
  if (o.sweeps < 1) return "at least one sweep is needed";
  std::vector<float> weights{o.eta, o.tau, o.empty_penalty};
  for (const auto* list : {&o.theta, &o.omega}) weights.insert(weights.end(), list->begin(), list->end());
  for (float w : weights)
    if (!(w >= 0 && w <= 100)) return "weights must lie in 0 to 100";
  return {};
}

// [frame][face]: the ranks of each tuple, a byte each.
std::vector<uint8_t> tupleBytes(std::span<const WindowFrame> frames) {
  std::vector<uint8_t> out;
  for (const WindowFrame& frame : frames)
    for (const LabelTuple& tuple : *frame.labels) out.insert(out.end(), tuple.ranks.begin(), tuple.ranks.end());
  return out;
}

// Reads tupleBytes() back into the frames. Returns false, with the frames unchanged, if the number of bytes does not
// fit the frames and faces.
bool takeTuples(const std::vector<uint8_t>& bytes, std::span<const WindowFrame> frames) {
  constexpr size_t kTuple = package::kMaxLayers;
  const size_t faces = frames[0].costs->feasible.size();
  if (bytes.size() != frames.size() * faces * kTuple) return false;
  auto from = bytes.begin();
  for (const WindowFrame& frame : frames) {
    frame.labels->assign(faces, {});
    for (LabelTuple& tuple : *frame.labels) {
      std::copy_n(from, kTuple, tuple.ranks.begin());
      from += kTuple;
    }
  }
  return true;
}

// Frames between their first load and their finish.
class Solver {
 public:
  Solver(const LabelOptions& options, const FaceGraph& graph, const LabelExchange& exchange)
      : options_(options), graph_(graph), links_(makeFaceLinks(graph)), exchange_(exchange), meter_(options, graph) {}

  Status load(const LabelWindow& window) {
    for (uint32_t t = window.fresh_first; t < window.fresh_end; ++t) {
      const Watch watch;
      auto costs = exchange_.costs(t);
      outside_s_ += watch.seconds();
      if (!costs) return costs.error();
      std::lock_guard lock(mutex_);
      frames_[t].costs = costs.take();
    }
    return {};
  }

  void solve(const LabelWindow& window) {
    std::vector<WindowFrame> frames;
    {
      std::lock_guard lock(mutex_);  // references into the map stay valid
      for (uint32_t t = window.frozen_first; t < window.frozen_end; ++t) {
        Frame& frame = frames_[t];
        const bool frozen = t < window.first || t >= window.end;
        const bool fresh = t >= window.fresh_first && t < window.fresh_end;
        frames.push_back({&frame.costs, &frame.labels, frozen, !frozen && !fresh});
      }
    }
    const bool kept = exchange_.keeper && options_.rule->windowed;
    const auto solved = std::span(frames).subspan(window.first - window.frozen_first, window.end - window.first);
    if (kept && takeTuples(exchange_.keeper->find(window.first, window.end), solved)) return;
    options_.rule->solve(options_, links_, frames);
    if (!kept) return;
    const Status keeping = exchange_.keeper->keep(window.first, window.end, tupleBytes(solved));
    std::lock_guard lock(mutex_);
    if (!keeping.ok()) keeping_ = keeping;
  }

  Status finish(uint32_t t) {
    {
      std::lock_guard lock(mutex_);
      FOURDVT_TRY(keeping_);
    }
    const Frame& frame = frames_[t];
    const size_t faces = graph_.face_count;
    std::vector<uint8_t> labels(options_.layers * faces);
    for (int l = 0; l < options_.layers; ++l)
      for (size_t f = 0; f < faces; ++f) labels[l * faces + f] = frame.labels[f].ranks[l];
    const Watch watch;
    meter_.add(frame.costs, labels);
    FOURDVT_TRY(exchange_.sink(t, labels));
    outside_s_ += watch.seconds();
    std::lock_guard lock(mutex_);
    frames_.erase(t);
    return {};
  }

  Status keeping() const { return keeping_; }  // error of the keeper

  LabelStatistics statistics() const {
    LabelStatistics out = meter_.statistics();
    out.seconds = watch_.seconds() - outside_s_;
    return out;
  }

 private:
  struct Frame {
    FaceCosts costs;
    std::vector<LabelTuple> labels;
  };
  const LabelOptions& options_;
  const FaceGraph& graph_;
  const FaceLinks links_;
  const LabelExchange& exchange_;
  LabelMeter meter_;
  std::mutex mutex_;  // guards frames_ as a map; every frame belongs to one window at a time
  std::map<uint32_t, Frame> frames_;
  Status keeping_;
  const Watch watch_;
  double outside_s_ = 0;  // spent in source, sink and meter
};

}  // namespace

float weightOfRank(const std::vector<float>& weights, int rank) {
  return weights.empty() ? 0 : weights[std::min<size_t>(rank, weights.size() - 1)];
}

FaceGraph makeFaceGraph(const MeshTopology& topology) {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> faces_of_edge;
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    const glm::uvec3 v = topology.face_vertices[f];
    for (int k = 0; k < 3; ++k) faces_of_edge[std::minmax(v[k], v[(k + 1) % 3])].push_back(f);
  }
  FaceGraph graph;
  graph.face_count = topology.faceCount();
  for (const auto& [edge, faces] : faces_of_edge)
    for (size_t i = 0; i < faces.size(); ++i)
      for (size_t j = i + 1; j < faces.size(); ++j)
        if (faces[i] != faces[j]) graph.edges.push_back({faces[i], faces[j]});
  std::sort(graph.edges.begin(), graph.edges.end());
  graph.edges.erase(std::unique(graph.edges.begin(), graph.edges.end()), graph.edges.end());
  graph.neighbour_count.assign(graph.face_count, 0);
  for (auto [f, g] : graph.edges)
    for (uint32_t face : {f, g})
      if (graph.neighbour_count[face] < 255) ++graph.neighbour_count[face];
  return graph;
}

Result<LabelStatistics> solveLabels(const LabelOptions& options, const FaceGraph& graph, uint32_t frame_count,
                                    const LabelExchange& exchange) {
  if (const std::string wrong = complaint(options); !wrong.empty())
    return Error{ErrorId::InvalidArgument, "labelling: " + wrong};
  Solver solver(options, graph, exchange);
  const auto finish = [&](uint32_t frame) -> Status {
    FOURDVT_TRY(solver.finish(frame));
    if (exchange.on_frame) exchange.on_frame(frame + 1);
    return {};
  };
  FOURDVT_TRY(runWindows(
      planWindows(options, frame_count), frame_count, std::max(1, options.jobs),
      {[&](const LabelWindow& w) { return solver.load(w); }, [&](const LabelWindow& w) { solver.solve(w); }, finish},
      exchange.stop));
  return solver.statistics();
}

Status solveLabelWindows(const LabelOptions& options, const FaceGraph& graph, uint32_t frame_count,
                         const std::vector<size_t>& windows, const LabelExchange& exchange) {
  if (const std::string wrong = complaint(options); !wrong.empty())
    return Error{ErrorId::InvalidArgument, "labelling: " + wrong};
  const std::vector<LabelWindow> all = planWindows(options, frame_count);
  for (const size_t number : windows) {
    const LabelWindow& window = all[number];
    if (!exchange.keeper->find(window.first, window.end).empty()) continue;
    Solver solver(options, graph, exchange);
    std::vector<const LabelWindow*> steps;
    if (window.odd) steps = {&all[number - 1], &all[number + 1]};
    steps.push_back(&window);
    for (const LabelWindow* step : steps) {
      if (exchange.stop && *exchange.stop) return Error{ErrorId::Interrupted, "stopped while labelling"};
      FOURDVT_TRY(solver.load(*step));
      solver.solve(*step);
    }
    FOURDVT_TRY(solver.keeping());
  }
  return {};
}

namespace {

double percent(uint64_t part, double whole) { return whole > 0 ? 100 * double(part) / whole : 0; }

// Per face, 1: a camera sees it.
std::vector<uint8_t> seenFaces(const FaceCosts& costs, size_t faces) {
  std::vector<uint8_t> seen(faces, 1);
  for (size_t f = 0; f < costs.unseen.size(); ++f) seen[f] = !costs.unseen[f];
  return seen;
}

}  // namespace

LabelMeter::LabelMeter(const LabelOptions& options, const FaceGraph& graph)
    : options_(options), graph_(graph), layers_(options.layers) {}

// algorithms/labels.md: d(a,b) = Σ_l ω_l [a_l ≠ b_l] + (η/2) |S_a Δ S_b|.
double LabelMeter::distance(const std::vector<uint8_t>& a, size_t f, const std::vector<uint8_t>& b, size_t g) const {
  double sum = 0;
  uint32_t set_a = 0, set_b = 0;
  for (int l = 0; l < options_.layers; ++l) {
    const uint8_t x = a[l * graph_.face_count + f], y = b[l * graph_.face_count + g];
    if (x != y) sum += weightOfRank(options_.omega, l);
    if (x != package::kNoCamera) set_a |= 1u << x;
    if (y != package::kNoCamera) set_b |= 1u << y;
  }
  return sum + 0.5 * options_.eta * std::popcount(set_a ^ set_b);
}

void LabelMeter::addLayer(const FaceCosts& costs, const uint8_t* layer, int l, const std::vector<uint8_t>& seen) {
  Counts& counts = layers_[l];
  const auto count = [](uint8_t a, uint8_t b, bool is_seen, uint64_t& all, uint64_t& cameras, uint64_t& of_seen) {
    if (a == b) return;
    ++all;
    if (a != package::kNoCamera && b != package::kNoCamera) ++cameras;
    if (is_seen) ++of_seen;
  };
  const size_t faces = graph_.face_count;
  for (size_t f = 0; f < faces; ++f) {
    const bool filled = layer[f] != package::kNoCamera;
    const double p = filled ? costs.penalty[f * costs.camera_count + layer[f]] : options_.empty_penalty;
    energy_ += weightOfRank(options_.theta, l) * p;
    if (filled) ++counts.filled;
    if (filled && seen[f]) ++counts.filled_seen, counts.penalty += p;
    if (frames_ > 0)
      count(layer[f], previous_[l * faces + f], seen[f] && previous_seen_[f], counts.flips, counts.camera_flips,
            counts.seen_flips);
  }
  for (auto [f, g] : graph_.edges)
    count(layer[f], layer[g], seen[f] && seen[g], counts.seams, counts.camera_seams, counts.seen_seams);
}

void LabelMeter::add(const FaceCosts& costs, const std::vector<uint8_t>& labels) {
  const size_t faces = graph_.face_count;
  std::vector<uint8_t> seen = seenFaces(costs, faces);
  for (int l = 0; l < options_.layers; ++l) addLayer(costs, labels.data() + l * faces, l, seen);
  for (auto [f, g] : graph_.edges) {
    energy_ += (1.0 / graph_.neighbour_count[f] + 1.0 / graph_.neighbour_count[g]) * distance(labels, f, labels, g);
    seen_edges_ += seen[f] && seen[g];
  }
  for (size_t f = 0; frames_ > 0 && f < faces; ++f) {
    energy_ += options_.tau * distance(labels, f, previous_, f);
    seen_steps_ += seen[f] && previous_seen_[f];
  }
  previous_ = labels;
  previous_seen_ = std::move(seen);
  ++frames_;
}

LabelStatistics LabelMeter::statistics() const {
  LabelStatistics out;
  out.frames = frames_;
  out.energy = energy_;
  const double faces = graph_.face_count, ranks = faces * options_.layers * frames_;
  const double edges = static_cast<double>(graph_.edges.size()) * frames_;
  const double steps = faces * (frames_ > 1 ? frames_ - 1 : 0);
  double filled = 0;
  for (const Counts& counts : layers_) {
    out.seam_percent.push_back(percent(counts.seams, edges));
    out.flip_percent.push_back(percent(counts.flips, steps));
    out.camera_seam_percent.push_back(percent(counts.camera_seams, edges));
    out.camera_flip_percent.push_back(percent(counts.camera_flips, steps));
    out.seen_seam_percent.push_back(percent(counts.seen_seams, double(seen_edges_)));
    out.seen_flip_percent.push_back(percent(counts.seen_flips, double(seen_steps_)));
    out.mean_penalty.push_back(counts.filled_seen ? counts.penalty / double(counts.filled_seen) : 0);
    filled += double(counts.filled);
  }
  out.empty_percent = ranks > 0 ? 100 * (1 - filled / ranks) : 0;
  return out;
}

}  // namespace fourdvt::bake
