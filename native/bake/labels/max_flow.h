// SPDX-License-Identifier: Apache-2.0
// Minimum of Σ u_i x_i + Σ c_ij (1-x_i) x_j over binary x, c ≥ 0, by maximum flow (Y. Boykov, V. Kolmogorov: An
// Experimental Comparison of Min-Cut/Max-Flow Algorithms for Energy Minimization in Vision, IEEE Transactions on
// Pattern Analysis and Machine Intelligence 26(9), 2004), growing the sink's trees only, so that the work stays near
// the nodes that gain by x = 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fourdvt::bake {

class LabelFlow {
 public:
  // Clears the graph, keeps the memory. All x are 0 until solve().
  void reset(size_t nodes);
  void addUnary(int i, int32_t u) { nodes_[i].excess += u; }
  // `c_ij` is paid where x_i = 0 and x_j = 1, `c_ji` where x_i = 1 and x_j = 0.
  void addPair(int i, int j, int32_t c_ij, int32_t c_ji);
  void solve();
  // Value of x_i in the minimum with the fewest ones.
  bool one(int i) const { return nodes_[i].parent != kFree; }

 private:
  static constexpr int32_t kFree = -1, kRoot = -2, kOrphan = -3;
  struct Node {
    int32_t excess = 0;      // > 0: residual capacity from the source, < 0: to the sink
    int32_t first = -1;      // first arc of the node
    int32_t parent = kFree;  // arc towards the sink, or one of the above
    int32_t stamp = 0, distance = 0;
    bool queued = false;
  };
  struct Arc {
    int32_t head, next, capacity;  // residual; the opposite arc is index ^ 1
  };

  void activate(int v);
  void grow(int v);
  void augment(int source, int32_t arc);
  void adoptOrphans();
  int distanceToRoot(int v);  // INT32_MAX: its tree ends in an orphan
  bool findParent(int v);
  void release(int v);

  std::vector<Node> nodes_;
  std::vector<Arc> arcs_;
  std::vector<int> active_, orphans_;
  size_t next_active_ = 0;
  int32_t stamp_ = 0;
};

}  // namespace fourdvt::bake
