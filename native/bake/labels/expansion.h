// SPDX-License-Identifier: Apache-2.0
// Alpha-expansion over several frames at once (algorithms/labels.md). Lowers
// E = Σ_t [ Σ_f Σ_l θ_l p(z_f^l, f) + Σ_fg κ_fg d(z_f, z_g) ] + τ Σ_t,f d(z_f(t), z_f(t-1)),
// d(a,b) = Σ_l ω_l [a_l ≠ b_l] + (η/2) |S_a Δ S_b|,   κ_fg = 1/|N_f| + 1/|N_g|,
// by moves "rank l ← α, with swap". With one rank, ω = 1 and η = 0 it is 4DVT Eq. 2-5 (Casas et al. 2014, labelling.h).
// Rank 0 of a face that has an allowed camera is never empty. Energies are integers: a move never raises them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/labels/face_costs.h"
#include "bake/labels/labelling.h"
#include "bake/labels/max_flow.h"
#include "package/character.h"

namespace fourdvt::bake {

// One face's ordered tuple of distinct cameras.
struct LabelTuple {
  std::array<uint8_t, package::kMaxLayers> ranks;  // camera or package::kNoCamera
  LabelTuple() { ranks.fill(package::kNoCamera); }
  bool operator==(const LabelTuple& o) const { return ranks == o.ranks; }
};

// The `count` cheapest cameras of `allowed` in ascending order of penalty; ties are ordered by camera index. Used by
// the lab's "naive" rule and as the initial labels of every solve.
inline LabelTuple cheapestCameras(const FaceCosts& costs, size_t face, uint32_t allowed, int count) {
  LabelTuple out;
  const float* penalties = costs.penalty.data() + face * costs.camera_count;
  for (int rank = 0; rank < count && allowed; ++rank) {
    int best = -1;
    for (int c = 0; c < costs.camera_count; ++c)
      if ((allowed >> c & 1) && (best < 0 || penalties[c] < penalties[best])) best = c;
    out.ranks[rank] = static_cast<uint8_t>(best);
    allowed &= ~(1u << best);
  }
  return out;
}

// Neighbours of each face, from FaceGraph; κ in units of 2^-16.
struct FaceLinks {
  struct Link {
    uint32_t face;
    int32_t kappa;
  };
  std::vector<uint32_t> first;  // face_count + 1
  std::vector<Link> links;
  uint32_t faceCount() const { return static_cast<uint32_t>(first.size()) - 1; }
};
FaceLinks makeFaceLinks(const FaceGraph& graph);

// Weights of the energy, scaled to integers such that no node's sum overflows 32 bits.
struct LabelWeights {
  int ranks = 1;
  std::array<float, package::kMaxLayers> theta{};    // energy units per penalty
  std::array<int32_t, package::kMaxLayers> omega{};  // times κ or τ gives energy units
  int32_t half_eta = 0, tau = 0;
  float empty_penalty = 0;
  double units = 1;  // energy units per 1 of E
  static LabelWeights joint(const LabelOptions& options, const FaceLinks& links);
};

struct BlockFrame {
  const FaceCosts* costs = nullptr;                // borrowed, as are the two below; not read if frozen
  const std::vector<uint32_t>* allowed = nullptr;  // cameras allowed for each face, as bits
  std::vector<LabelTuple>* labels = nullptr;       // in: distinct cameras, all allowed; out: the result
  bool frozen = false;                             // labels are fixed
  bool settled = false;                            // its labels are a minimum already, unless neighbours change
};

class ExpansionBlock {
 public:
  // Neighbouring entries of `frames` are neighbours in time.
  ExpansionBlock(const LabelWeights& weights, const FaceLinks& links, std::vector<BlockFrame> frames);
  // Sweeps over all ranks and cameras until nothing changes, then writes the labels back.
  void solve(int sweeps);
  // Tries one move, near the changes since the last try of the same move; package::kNoCamera empties the rank. Returns
  // false without a gain.
  bool expand(int rank, uint8_t camera);
  int64_t energy() const;
  LabelTuple label(size_t frame, uint32_t face) const;
  int cameraCount() const { return camera_count_; }

 private:
  struct Tuple {
    uint64_t ranks;  // a byte each, lowest first
    uint32_t set;
    bool operator==(const Tuple& o) const { return ranks == o.ranks; }
  };
  struct Candidate {
    uint32_t node;
    Tuple moved;
  };
  int32_t distance(const Tuple& a, const Tuple& b) const;
  int32_t unary(size_t node, int rank, uint8_t camera) const;
  int32_t unary(size_t node, const Tuple& tuple) const;
  bool moved(size_t node, int rank, uint8_t camera, Tuple& out) const;
  void gather(size_t log_start);
  template <class Visit>
  void forNeighbours(uint32_t node, Visit&& visit) const;  // visit(node, weight)
  void addNode(int index);
  bool apply();

  LabelWeights weights_;
  const FaceLinks& links_;
  std::vector<BlockFrame> frames_;
  uint32_t faces_ = 0;
  int camera_count_ = 0;
  std::vector<Tuple> labels_;      // frame × face
  std::vector<uint32_t> allowed_;  // 0 where frozen
  std::vector<uint8_t> frozen_;    // [frame]
  std::vector<uint32_t> log_;      // changed nodes in order of time; starts with the unsettled ones
  std::vector<std::array<size_t, package::kMaxCameras + 1>> tried_;  // [rank][camera]: log size at the last try
  std::vector<uint32_t> near_;                                       // nodes to be tried
  std::vector<uint8_t> is_near_;
  std::vector<Candidate> candidates_;
  std::vector<int32_t> candidate_of_;  // [node] its candidate; -1: fixed
  LabelFlow flow_;
};

// One of the frames whose labels a rule (Labelling::solve) solves together.
struct WindowFrame {
  const FaceCosts* costs = nullptr;           // borrowed
  std::vector<LabelTuple>* labels = nullptr;  // borrowed; out
  bool frozen = false;                        // labels are fixed
  bool solved = false;                        // labels come from another window and are to be improved
};

// Labels every face with the cheapest cameras that see it.
void labelByPenalty(const FaceCosts& costs, int layers, std::vector<LabelTuple>& labels);

}  // namespace fourdvt::bake
