// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "bake/motion/transitions.h"
#include "bake/run/stream_reader.h"
#include "bake/stages/stages.h"

namespace fourdvt::bake {
namespace {

constexpr int kInnerPoints = 3;
constexpr const char* kGraphResult = "graph.result";

std::vector<std::pair<size_t, size_t>> neighbours(const ClassPlan& plan) {
  std::vector<size_t> order(plan.members.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::vector<std::pair<size_t, size_t>> pairs;
  if (plan.space.names.size() == 1) {
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return plan.manifest[a].parameter[0] < plan.manifest[b].parameter[0]; });
    for (size_t i = 0; i + 1 < order.size(); ++i) pairs.push_back({order[i], order[i + 1]});
    return pairs;
  }
  for (size_t a = 0; a < order.size(); ++a)
    for (size_t b = a + 1; b < order.size(); ++b) pairs.push_back({a, b});
  return pairs;
}

// Adapts one stream to the interface of a graph state.
class State {
 public:
  State(const Job& job, const StreamPlan& plan, std::vector<std::vector<float>> weights, const ReadPositions& read,
        const NonlinearBlend* blend)
      : plan_(plan),
        weights_(std::move(weights)),
        read_(read),
        blend_(blend),
        origin_(job.bounds.min),
        step_m_(gridStep_m(job.options)) {}

  Status loadAtlases(const WorkFolder& work);
  TransitionState description() const;

 private:
  Result<Positions> positions(uint32_t row, uint32_t frame) const;
  Positions asStreamed(Positions positions) const;
  glm::vec3 root(uint32_t row, uint32_t frame) const;
  Image atlas(uint32_t row, uint32_t frame) const;

  const StreamPlan& plan_;
  const std::vector<std::vector<float>> weights_;  // [row][member]
  const ReadPositions& read_;
  const NonlinearBlend* blend_;
  const glm::dvec3 origin_;  // origin of the grid of streamed vertices
  const double step_m_;
  std::vector<Image> atlases_;  // [frame][member]
};

Status State::loadAtlases(const WorkFolder& work) {
  for (uint32_t g = 0; g < plan_.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(auto artefact, work.load<GopArtefact>(gopFile(plan_.name, g)));
    for (Image& image : artefact.atlases) atlases_.push_back(std::move(image));
  }
  if (atlases_.size() == plan_.frameCount() * plan_.motion.members.size()) return {};
  return Error{ErrorId::Internal,
               work.path() + ": GOPs of " + plan_.name + " lack frames; delete this folder and bake again"};
}

TransitionState State::description() const {
  TransitionState state;
  state.frame_count = plan_.frameCount();
  for (const std::vector<float>& weights : weights_) {
    double duration_s = 0;
    for (size_t m = 0; m < weights.size(); ++m) duration_s += weights[m] * plan_.motion.manifest[m].duration_s;
    state.frames_per_s.push_back(plan_.frameCount() / duration_s);
  }
  state.loop = plan_.motion.loop;
  state.weight_rows = weights_;
  state.positions = [this](uint32_t row, uint32_t frame) { return positions(row, frame); };
  state.root = [this](uint32_t row, uint32_t frame) { return root(row, frame); };
  state.atlas = [this](uint32_t row, uint32_t frame) -> Result<Image> { return atlas(row, frame); };
  return state;
}

Result<Positions> State::positions(uint32_t row, uint32_t frame) const {
  const auto& members = plan_.motion.members;
  if (!plan_.isClass()) {
    FOURDVT_ASSIGN(auto mesh, read_(*members[0].source, frame));
    return asStreamed(std::move(mesh));
  }
  const std::vector<float>& weights = weights_[row];
  std::vector<Positions> meshes;
  for (size_t m = 0; m < members.size(); ++m) {
    FOURDVT_ASSIGN(auto mesh, memberPositions(members[m], frame, read_));
    meshes.push_back(asStreamed(std::move(mesh)));
    if (weights[m] == 1) return std::move(meshes.back());
  }
  return blend_->blend(meshes, weights);
}

Positions State::asStreamed(Positions positions) const {
  for (glm::vec3& p : positions) p = origin_ + step_m_ * gridPlace(p, origin_, step_m_);
  return positions;
}

glm::vec3 State::root(uint32_t row, uint32_t frame) const {
  glm::vec3 mixed(0);
  for (size_t m = 0; m < weights_[row].size(); ++m) mixed += weights_[row][m] * plan_.motion.members[m].root[frame];
  return mixed;
}

Image State::atlas(uint32_t row, uint32_t frame) const {
  const std::vector<float>& weights = weights_[row];
  const size_t heaviest = std::max_element(weights.begin(), weights.end()) - weights.begin();
  return atlases_[frame * weights.size() + heaviest];
}

}  // namespace

std::vector<std::vector<float>> graphWeights(const ClassPlan& plan) {
  std::vector<std::vector<float>> rows;
  for (size_t m = 0; m < plan.members.size(); ++m) {
    rows.emplace_back(plan.members.size());
    rows.back()[m] = 1;
  }
  if (rows.size() == 1) return rows;
  for (const auto& [a, b] : neighbours(plan)) {
    for (int i = 1; i <= kInnerPoints; ++i) {
      const float share = float(i) / (kInnerPoints + 1);
      rows.emplace_back(plan.members.size());
      rows.back()[a] = 1 - share;
      rows.back()[b] = share;
    }
  }
  return rows;
}

Result<std::vector<uint8_t>> makeGraph(BakeRun& run) {
  const Job& job = run.job;
  StageProgress progress(run.progress, infoOf(Stage::Graph).work_s * job.streamFrames());
  if (job.streams.size() < 2) return std::vector<uint8_t>();
  if (auto kept = run.work.load<store::Bytes>(kGraphResult)) return kept;
  StageClock::Span span(run.clock, Stage::Graph);
  FOURDVT_ASSIGN(const auto blend, NonlinearBlend::create(job.mesh.decoded.topology, job.mesh.decoded.positions));
  MeshReader meshes(job);
  const ReadPositions read = meshes.function();
  std::vector<State> states;
  states.reserve(job.streams.size());  // the descriptions point into it
  std::vector<TransitionState> descriptions;
  for (const StreamPlan& plan : job.streams) {
    states.emplace_back(job, plan, graphWeights(plan.motion), read, &blend);
    FOURDVT_TRY(states.back().loadAtlases(run.work));
    descriptions.push_back(states.back().description());
  }
  TransitionOptions options;
  options.atlas = kAtlasSide;
  options.pop.tick_s = 1 / job.capture.fps;
  const auto tell = [&](double share) {
    progress.done(share, "graph");
    return !run.stopped();
  };
  auto graph = buildMotionGraph(descriptions, options, tell);
  if (!graph && graph.error().id == ErrorId::Interrupted) FOURDVT_TRY(run.checkStop());
  if (graph) FOURDVT_TRY(run.work.save(kGraphResult, graph.value()));
  return graph;
}

}  // namespace fourdvt::bake
