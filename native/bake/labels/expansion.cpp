// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/expansion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "bake/labels/labelling.h"

namespace fourdvt::bake {
namespace {

constexpr double kKappaUnits = 65536;
constexpr int kRings = 2;  // rings of neighbours round a change that are tried again

constexpr uint8_t cameraAt(uint64_t ranks, int rank) { return static_cast<uint8_t>(ranks >> (8 * rank)); }

constexpr uint64_t withCamera(uint64_t ranks, int rank, uint8_t camera) {
  return (ranks & ~(uint64_t(255) << (8 * rank))) | uint64_t(camera) << (8 * rank);
}

constexpr uint32_t bitOf(uint8_t camera) { return camera == package::kNoCamera ? 0 : 1u << camera; }

// Energy units per 1 of E, such that the largest sum of terms at one node stays below 2^29. `theta_sum` and
// `omega_sum`: sums of the weights over the ranks.
double distanceUnits(const LabelOptions& options, double theta_sum, double omega_sum, const FaceLinks& links) {
  const double eta = options.eta, tau = options.tau;
  double kappa = 0;
  for (uint32_t f = 0; f < links.faceCount(); ++f) {
    double sum = 0;
    for (uint32_t k = links.first[f]; k < links.first[f + 1]; ++k) sum += links.links[k].kappa / kKappaUnits;
    kappa = std::max(kappa, sum);
  }
  const double largest = theta_sum + (kappa + 2 * tau) * (omega_sum + eta * options.layers);
  const double units = std::exp2(std::floor(std::log2(std::exp2(29) / std::max(largest, 1.0)))) / kKappaUnits;
  return std::clamp(units, 1.0, 1024.0);
}

}  // namespace

FaceLinks makeFaceLinks(const FaceGraph& graph) {
  FaceLinks out;
  out.first.assign(graph.face_count + 1, 0);
  for (auto [f, g] : graph.edges) ++out.first[f + 1], ++out.first[g + 1];
  for (uint32_t f = 0; f < graph.face_count; ++f) out.first[f + 1] += out.first[f];
  out.links.resize(2 * graph.edges.size());
  std::vector<uint32_t> next(out.first.begin(), out.first.end() - 1);
  for (auto [f, g] : graph.edges) {
    const double kappa = 1.0 / graph.neighbour_count[f] + 1.0 / graph.neighbour_count[g];
    const int32_t units = static_cast<int32_t>(std::lround(kappa * kKappaUnits));
    out.links[next[f]++] = {g, units};
    out.links[next[g]++] = {f, units};
  }
  return out;
}

LabelWeights LabelWeights::joint(const LabelOptions& options, const FaceLinks& links) {
  LabelWeights out;
  out.ranks = options.layers;
  double theta_sum = 0, omega_sum = 0;
  for (int l = 0; l < out.ranks; ++l) {
    theta_sum += weightOfRank(options.theta, l) * std::max(1.0f, options.empty_penalty);
    omega_sum += weightOfRank(options.omega, l);
  }
  const double units = distanceUnits(options, theta_sum, omega_sum, links);
  out.units = units * kKappaUnits;
  for (int l = 0; l < out.ranks; ++l) {
    out.theta[l] = static_cast<float>(weightOfRank(options.theta, l) * out.units);
    out.omega[l] = static_cast<int32_t>(std::lround(weightOfRank(options.omega, l) * units));
  }
  out.half_eta = static_cast<int32_t>(std::lround(0.5 * options.eta * units));
  out.tau = static_cast<int32_t>(std::lround(options.tau * kKappaUnits));
  out.empty_penalty = options.empty_penalty;
  return out;
}

ExpansionBlock::ExpansionBlock(const LabelWeights& weights, const FaceLinks& links, std::vector<BlockFrame> frames)
    : weights_(weights), links_(links), frames_(std::move(frames)), faces_(links.faceCount()) {
  const size_t nodes = frames_.size() * faces_;
  labels_.resize(nodes);
  allowed_.assign(nodes, 0);
  is_near_.assign(nodes, 0);
  candidate_of_.assign(nodes, -1);
  tried_.resize(weights_.ranks);
  for (auto& row : tried_) row.fill(0);
  for (size_t k = 0; k < frames_.size(); ++k) {
    const BlockFrame& frame = frames_[k];
    frozen_.push_back(frame.frozen);
    if (!frame.frozen) camera_count_ = frame.costs->camera_count;
    for (uint32_t f = 0; f < faces_; ++f) {
      const size_t node = k * faces_ + f;
      Tuple tuple{0, 0};
      for (int l = 0; l < weights_.ranks; ++l) {
        const uint8_t camera = (*frame.labels)[f].ranks[l];
        tuple.ranks = withCamera(tuple.ranks, l, camera);
        tuple.set |= bitOf(camera);
      }
      labels_[node] = tuple;
      if (frame.frozen) continue;
      allowed_[node] = (*frame.allowed)[f];
      if (!frame.settled && allowed_[node]) log_.push_back(static_cast<uint32_t>(node));
    }
  }
}

LabelTuple ExpansionBlock::label(size_t frame, uint32_t face) const {
  LabelTuple out;
  for (int l = 0; l < weights_.ranks; ++l) out.ranks[l] = cameraAt(labels_[frame * faces_ + face].ranks, l);
  return out;
}

inline int32_t ExpansionBlock::distance(const Tuple& a, const Tuple& b) const {
  const uint64_t differing = a.ranks ^ b.ranks;
  if (!differing) return 0;
  int32_t sum = 0;
  for (int l = 0; l < weights_.ranks; ++l) sum += cameraAt(differing, l) ? weights_.omega[l] : 0;
  return weights_.half_eta ? sum + weights_.half_eta * std::popcount(a.set ^ b.set) : sum;
}

inline int32_t ExpansionBlock::unary(size_t node, int rank, uint8_t camera) const {
  const FaceCosts& costs = *frames_[node / faces_].costs;
  const float p = camera == package::kNoCamera ? weights_.empty_penalty
                                               : costs.penalty[(node % faces_) * costs.camera_count + camera];
  return static_cast<int32_t>(weights_.theta[rank] * p);
}

int32_t ExpansionBlock::unary(size_t node, const Tuple& tuple) const {
  int32_t sum = 0;
  for (int l = 0; l < weights_.ranks; ++l) sum += unary(node, l, cameraAt(tuple.ranks, l));
  return sum;
}

// Sets `out` to the face's tuple after the move. Returns false if the move does not apply.
bool ExpansionBlock::moved(size_t node, int rank, uint8_t camera, Tuple& out) const {
  const Tuple& now = labels_[node];
  const uint8_t old = cameraAt(now.ranks, rank);
  if (old == camera) return false;
  if (camera == package::kNoCamera) {
    if (rank == 0 || !allowed_[node]) return false;
    out = {withCamera(now.ranks, rank, camera), now.set & ~bitOf(old)};
    return true;
  }
  if (!(allowed_[node] >> camera & 1)) return false;
  out.ranks = withCamera(now.ranks, rank, camera);
  if (!(now.set >> camera & 1)) {
    out.set = (now.set & ~bitOf(old)) | bitOf(camera);
    return true;
  }
  int holder = 0;
  while (cameraAt(now.ranks, holder) != camera) ++holder;
  if (holder == 0 && old == package::kNoCamera) return false;
  out.ranks = withCamera(out.ranks, holder, old);
  out.set = now.set;
  return true;
}

template <class Visit>
inline void ExpansionBlock::forNeighbours(uint32_t node, Visit&& visit) const {
  const uint32_t frame = node / faces_, face = node - frame * faces_, base = node - face;
  for (uint32_t k = links_.first[face]; k < links_.first[face + 1]; ++k)
    visit(base + links_.links[k].face, links_.links[k].kappa);
  if (weights_.tau == 0) return;
  if (frame > 0) visit(node - faces_, weights_.tau);
  if (frame + 1 < frames_.size()) visit(node + faces_, weights_.tau);
}

// Gathers the nodes within kRings of those in the log from `log_start` on.
void ExpansionBlock::gather(size_t log_start) {
  near_.clear();
  const auto take = [&](uint32_t node) {
    if (is_near_[node] || !allowed_[node]) return;
    is_near_[node] = 1;
    near_.push_back(node);
  };
  for (size_t i = log_start; i < log_.size(); ++i) take(log_[i]);
  size_t ring_start = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const size_t ring_end = near_.size();
    for (size_t i = ring_start; i < ring_end; ++i) forNeighbours(near_[i], [&](uint32_t n, int32_t) { take(n); });
    ring_start = ring_end;
  }
  for (uint32_t node : near_) is_near_[node] = 0;
}

// Adds the unary and pairwise terms of staying (x = 0) and moving (x = 1); pairs are added with later candidates
// only.
void ExpansionBlock::addNode(int index) {
  const Candidate& c = candidates_[index];
  const Tuple &stay = labels_[c.node], &move = c.moved;
  int32_t u = unary(c.node, move) - unary(c.node, stay);
  forNeighbours(c.node, [&](uint32_t n, int32_t weight) {
    const Tuple& other_stay = labels_[n];
    const int32_t stay_stay = distance(stay, other_stay), move_stay = distance(move, other_stay);
    u += weight * (move_stay - stay_stay);
    const int other = candidate_of_[n];
    if (other < index) return;
    const Tuple& other_move = candidates_[other].moved;
    const int32_t stay_move = distance(stay, other_move), move_move = distance(move, other_move);
    // Remainder beyond both unary terms: -gap x y = -g x - h y + g x (1-y) + h (1-x) y, g + h = gap.
    const int32_t gap = weight * (stay_move + move_stay - stay_stay - move_move), half = gap / 2;
    u -= half;
    flow_.addUnary(other, half - gap);
    flow_.addPair(index, other, gap - half, half);
  });
  flow_.addUnary(index, u);
}

bool ExpansionBlock::expand(int rank, uint8_t camera) {
  size_t& tried = tried_[rank][camera == package::kNoCamera ? package::kMaxCameras : camera];
  if (tried == log_.size()) return false;
  gather(tried);
  candidates_.clear();
  Candidate candidate;
  for (uint32_t node : near_) {
    if (!moved(node, rank, camera, candidate.moved)) continue;
    candidate.node = node;
    candidate_of_[node] = static_cast<int32_t>(candidates_.size());
    candidates_.push_back(candidate);
  }
  flow_.reset(candidates_.size());
  for (size_t i = 0; i < candidates_.size(); ++i) addNode(static_cast<int>(i));
  flow_.solve();
  const bool changed = apply();
  tried = log_.size();
  return changed;
}

bool ExpansionBlock::apply() {
  bool changed = false;
  for (size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& c = candidates_[i];
    candidate_of_[c.node] = -1;
    if (!flow_.one(static_cast<int>(i))) continue;
    labels_[c.node] = c.moved;
    log_.push_back(c.node);
    changed = true;
  }
  return changed;
}

void ExpansionBlock::solve(int sweeps) {
  bool changed = true;
  for (int sweep = 0; sweep < sweeps && changed; ++sweep) {
    changed = false;
    for (int rank = 0; rank < weights_.ranks; ++rank) {
      for (int c = 0; c < camera_count_; ++c) changed |= expand(rank, static_cast<uint8_t>(c));
      if (rank > 0) changed |= expand(rank, package::kNoCamera);
    }
  }
  for (size_t k = 0; k < frames_.size(); ++k)
    for (uint32_t f = 0; f < faces_ && !frozen_[k]; ++f) (*frames_[k].labels)[f] = label(k, f);
}

int64_t ExpansionBlock::energy() const {
  int64_t sum = 0;
  for (uint32_t node = 0; node < labels_.size(); ++node) {
    if (!frozen_[node / faces_]) sum += unary(node, labels_[node]);
    forNeighbours(node, [&](uint32_t n, int32_t weight) {
      if (n > node) sum += int64_t(weight) * distance(labels_[node], labels_[n]);
    });
  }
  return sum;
}

void labelByPenalty(const FaceCosts& costs, int layers, std::vector<LabelTuple>& labels) {
  labels.resize(costs.feasible.size());
  for (size_t f = 0; f < labels.size(); ++f) labels[f] = cheapestCameras(costs, f, costs.feasible[f], layers);
}

namespace {

std::vector<uint32_t> usableCameras(const LabelOptions& options, const FaceCosts& costs) {
  std::vector<uint32_t> out = costs.feasible;
  for (size_t f = 0; options.use_partial && f < costs.partial.size(); ++f) out[f] |= costs.partial[f];
  const uint32_t all = costs.camera_count >= 32 ? ~0u : (1u << costs.camera_count) - 1;
  for (size_t f = 0; options.label_unseen && f < costs.unseen.size(); ++f)
    if (costs.unseen[f]) out[f] = all;
  return out;
}

// Copies the neighbouring frame's cameras where they are still feasible, and fills the remaining ranks with the
// cheapest.
void labelByNeighbour(const FaceCosts& costs, const std::vector<uint32_t>& allowed, int layers,
                      const std::vector<LabelTuple>& neighbour, std::vector<LabelTuple>& labels) {
  labels.resize(allowed.size());
  for (size_t f = 0; f < labels.size(); ++f) {
    LabelTuple tuple = neighbour[f];
    uint32_t free = allowed[f];
    for (uint8_t& c : tuple.ranks) {
      if (c != package::kNoCamera && !(free >> c & 1)) c = package::kNoCamera;
      if (c != package::kNoCamera) free &= ~(1u << c);
    }
    const LabelTuple spare = cheapestCameras(costs, f, free, layers);
    for (int l = 0, s = 0; l < layers; ++l)
      if (tuple.ranks[l] == package::kNoCamera) tuple.ranks[l] = spare.ranks[s++];
    // Rank 0 may still be empty if the remaining cameras are in further ranks.
    for (int l = 1; l < layers && tuple.ranks[0] == package::kNoCamera; ++l) std::swap(tuple.ranks[0], tuple.ranks[l]);
    labels[f] = tuple;
  }
}

// Initialises every frame without labels: from the previous frame, or by solving one frame by itself.
void startJoint(const LabelOptions& options, const LabelWeights& weights, const FaceLinks& links,
                const std::vector<std::vector<uint32_t>>& allowed, std::vector<WindowFrame>& frames) {
  for (size_t k = 0; k < frames.size(); ++k) {
    WindowFrame& frame = frames[k];
    if (frame.frozen || frame.solved) continue;
    if (k > 0) {
      labelByNeighbour(*frame.costs, allowed[k], options.layers, *frames[k - 1].labels, *frame.labels);
      continue;
    }
    labelByPenalty(*frame.costs, options.layers, *frame.labels);
    ExpansionBlock(weights, links, {{frame.costs, &allowed[k], frame.labels}}).solve(options.sweeps);
  }
}

void solveJoint(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames) {
  const LabelWeights weights = LabelWeights::joint(options, links);
  std::vector<std::vector<uint32_t>> allowed(frames.size());
  for (size_t k = 0; k < frames.size(); ++k)
    if (!frames[k].frozen) allowed[k] = usableCameras(options, *frames[k].costs);
  startJoint(options, weights, links, allowed, frames);
  std::vector<BlockFrame> block;
  for (size_t k = 0; k < frames.size(); ++k)
    block.push_back({frames[k].costs, &allowed[k], frames[k].labels, frames[k].frozen, frames[k].solved});
  ExpansionBlock(weights, links, std::move(block)).solve(options.sweeps);
}

}  // namespace

const Labelling kJoint{"joint", true, solveJoint};

}  // namespace fourdvt::bake
