// SPDX-License-Identifier: Apache-2.0
#include "motion/motion_graph.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"

namespace fourdvt::motion {
namespace {

Error invalid(const char* what) {
  return {ErrorId::StreamInvalid, std::string("motion graph: ") + what +
                                      "; the file is damaged or of another character: bake the character again"};
}

bool readState(ByteReader& in, const package::Sequence& sequence, GraphState& state) {
  state.frame_count = in.u32();
  const uint32_t rows = in.u32();
  const size_t members = sequence.members.size();
  if (!in.ok() || state.frame_count != sequence.frame_count || rows == 0 || members == 0 ||
      in.remaining() / (4 * members) < rows) {
    return false;
  }
  for (uint32_t r = 0; r < rows; ++r) {
    std::vector<float> row(members);
    float sum = 0;
    for (float& weight : row) {
      weight = in.f32();
      if (!(weight >= 0 && weight <= 1)) return false;
      sum += weight;
    }
    if (std::abs(sum - 1) > 1e-3f) return false;
    state.weight_rows.push_back(std::move(row));
  }
  return true;
}

bool readTable(ByteReader& in, const GraphState& source, const GraphState& target, bool same,
               std::vector<Entry>& table) {
  const uint32_t count = in.u32();
  if (!in.ok()) return false;
  if (count == 0) return true;
  if (same || count != source.frame_count * uint64_t(source.weight_rows.size()) ||
      in.remaining() / kGraphEntryBytes < count) {
    return false;
  }
  table.resize(count);
  for (Entry& entry : table) {
    entry.frame = in.u32();
    entry.weight_row = in.u16();
    entry.fade_frames = in.u16();
    entry.cost = in.f32();
    for (int i = 0; i < 3; ++i) entry.shift[i] = in.f32();
    if (entry.frame >= target.frame_count || entry.weight_row >= target.weight_rows.size() || !entry.fade_frames ||
        !(entry.cost >= 0) || !std::isfinite(entry.cost + entry.shift.x + entry.shift.y + entry.shift.z)) {
      return false;
    }
  }
  return true;
}

uint32_t nearestRow(const GraphState& state, std::span<const float> weights) {
  uint32_t nearest = 0;
  float min_distance = 1e30f;
  for (uint32_t r = 0; r < state.weight_rows.size(); ++r) {
    const std::vector<float>& row = state.weight_rows[r];
    float distance = 0;
    for (size_t m = 0; m < row.size(); ++m) distance += std::abs(row[m] - (m < weights.size() ? weights[m] : 0));
    if (distance < min_distance) {
      min_distance = distance;
      nearest = r;
    }
  }
  return nearest;
}

}  // namespace

Result<MotionGraph> MotionGraph::read(std::span<const uint8_t> bytes, const package::Character& character) {
  ByteReader in(bytes);
  if (in.u32() != kGraphMagic || in.u16() != kGraphVersion || in.u16() != 0) return invalid("unknown kind or version");
  if (in.u32() != bytes.size()) return invalid("length differs from the file's");
  const size_t count = character.sequences.size();
  if (in.u32() != count || !in.ok()) return invalid("states differ from the manifest's");
  MotionGraph graph;
  graph.states_.resize(count);
  graph.tables_.resize(count * count);
  for (size_t s = 0; s < count; ++s) {
    if (!readState(in, character.sequences[s], graph.states_[s])) return invalid("bad state");
    graph.loops_.push_back(character.sequences[s].loop);
  }
  for (size_t t = 0; t < graph.tables_.size(); ++t) {
    const size_t source = t / count, target = t % count;
    if (!readTable(in, graph.states_[source], graph.states_[target], source == target, graph.tables_[t]))
      return invalid("bad transitions");
  }
  if (!in.ok() || in.remaining() != 0) return invalid("trailing bytes");
  return graph;
}

const Entry* MotionGraph::entry(int source, uint32_t frame, uint32_t weight_row, int target) const {
  const int count = int(states_.size());
  if (source < 0 || target < 0 || source >= count || target >= count) return nullptr;
  const GraphState& state = states_[source];
  const std::vector<Entry>& table = tables_[size_t(source) * count + target];
  if (table.empty() || frame >= state.frame_count || weight_row >= state.weight_rows.size()) return nullptr;
  return &table[size_t(weight_row) * state.frame_count + frame];
}

std::optional<Transition> MotionGraph::plan(const PlayedState& from, int target, const PlanOptions& options) const {
  const int source = from.source;
  const double frames_per_s = from.frames_per_s;
  if (source < 0 || size_t(source) >= states_.size()) return std::nullopt;
  const GraphState& state = states_[source];
  const uint32_t last = state.frame_count - 1, row = nearestRow(state, from.weights);
  const uint32_t frame = std::min(from.frame, last);
  // A motion that does not loop shows no new frame after its end; a loop shows every frame within one pass.
  const double longest = loops_[source] ? 1e6 : last - frame;
  const auto frames = [&](double wait) { return uint32_t(std::clamp(wait, 0.0, longest)); };
  const uint32_t first = frames(std::ceil(options.min_wait_s * frames_per_s - 1e-6));
  const uint32_t waits = std::min(std::max(first, frames(options.max_latency_s * frames_per_s + 1e-6)), first + last);
  std::optional<Transition> best;
  double min_cost = 1e300;
  for (uint32_t wait = first; wait <= waits; ++wait) {
    const uint32_t exit = (frame + wait) % state.frame_count;
    const Entry* found = entry(source, exit, row, target);
    if (!found) return std::nullopt;
    const double waited_s = wait > 0 ? wait / frames_per_s : 0;
    const double cost = found->cost + options.latency_cost_mm_per_s * waited_s;
    if (cost < min_cost) {
      min_cost = cost;
      best = Transition{source, target, exit, wait, *found};
    }
  }
  return best;
}

float fadeWeight(double frames, uint32_t fade_frames) {
  const double x = std::min((frames + 1) / (fade_frames + 1), 1.0);
  return static_cast<float>(x * x * (3 - 2 * x));
}

}  // namespace fourdvt::motion
