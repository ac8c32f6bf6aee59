// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/labelling.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <span>

#include "bake/labels/schedule.h"
#include "bake/labels/statistics.h"
#include "bake/labels/window.h"

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

// Reads them back into the frames. False if the number of bytes fits another number of frames or faces; nothing changes
// then.
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

// The frames between their first load and their finish.
class Solver {
 public:
  Solver(const LabelOptions& options, const FaceGraph& graph, const LabelExchange& exchange)
      : options_(options), graph_(graph), links_(makeFaceLinks(graph)), exchange_(exchange), meter_(options, graph) {}

  Status load(const LabelWindow& window) {
    for (uint32_t t = window.fresh_first; t < window.fresh_end; ++t) {
      const auto started = Clock::now();
      auto costs = exchange_.costs(t);
      outside_ += Clock::now() - started;
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
    const auto started = Clock::now();
    meter_.add(frame.costs, labels);
    FOURDVT_TRY(exchange_.sink(t, labels));
    outside_ += Clock::now() - started;
    std::lock_guard lock(mutex_);
    frames_.erase(t);
    return {};
  }

  Status keeping() const { return keeping_; }  // an error of the keeper

  LabelStatistics statistics() const {
    LabelStatistics out = meter_.statistics();
    out.seconds = std::chrono::duration<double>(Clock::now() - started_ - outside_).count();
    return out;
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    FaceCosts costs;
    std::vector<LabelTuple> labels;
  };
  const LabelOptions& options_;
  const FaceGraph& graph_;
  const FaceLinks links_;
  const LabelExchange& exchange_;
  LabelMeter meter_;
  std::mutex mutex_;  // frames_ as a map; every frame belongs to one window at a time
  std::map<uint32_t, Frame> frames_;
  Status keeping_;
  Clock::time_point started_ = Clock::now();
  Clock::duration outside_{};  // spent in source, sink and meter
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

}  // namespace fourdvt::bake
