// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/max_flow.h"

#include <algorithm>

namespace fourdvt::bake {

void LabelFlow::reset(size_t nodes) {
  nodes_.assign(nodes, Node());
  arcs_.clear();
  active_.clear();
  orphans_.clear();
  next_active_ = 0;
  stamp_ = 0;
}

void LabelFlow::addPair(int i, int j, int32_t c_ij, int32_t c_ji) {
  const int32_t index = static_cast<int32_t>(arcs_.size());
  arcs_.push_back({j, nodes_[i].first, c_ij});
  arcs_.push_back({i, nodes_[j].first, c_ji});
  nodes_[i].first = index;
  nodes_[j].first = index + 1;
}

void LabelFlow::activate(int v) {
  if (nodes_[v].queued) return;
  nodes_[v].queued = true;
  active_.push_back(v);
}

void LabelFlow::solve() {
  for (size_t v = 0; v < nodes_.size(); ++v) {
    if (nodes_[v].excess >= 0) continue;
    nodes_[v].parent = kRoot;
    nodes_[v].distance = 1;
    activate(static_cast<int>(v));
  }
  while (next_active_ < active_.size()) {
    const int v = active_[next_active_++];
    nodes_[v].queued = false;
    if (nodes_[v].parent != kFree) grow(v);
    if (next_active_ > 4096 && 2 * next_active_ > active_.size()) {
      active_.erase(active_.begin(), active_.begin() + static_cast<std::ptrdiff_t>(next_active_));
      next_active_ = 0;
    }
  }
}

// Adds every neighbour with residual capacity towards v to the tree; flow from nodes with excess is pushed at once.
void LabelFlow::grow(int v) {
  for (int32_t a = nodes_[v].first; a >= 0; a = arcs_[a].next) {
    const int32_t inward = a ^ 1;
    Node& u = nodes_[arcs_[a].head];
    while (arcs_[inward].capacity > 0 && u.parent == kFree && u.excess > 0) {
      augment(arcs_[a].head, inward);
      if (nodes_[v].parent == kFree) return;
    }
    if (arcs_[inward].capacity == 0) continue;
    const Node& node = nodes_[v];
    if (u.parent == kFree) {
      u.parent = inward;
      u.stamp = node.stamp;
      u.distance = node.distance + 1;
      activate(arcs_[a].head);
    } else if (u.parent >= 0 && u.stamp <= node.stamp && u.distance > node.distance + 1) {
      u.parent = inward;  // this way is shorter
      u.stamp = node.stamp;
      u.distance = node.distance + 1;
    }
  }
}

void LabelFlow::augment(int source, int32_t arc) {
  int32_t amount = std::min(nodes_[source].excess, arcs_[arc].capacity);
  int v = arcs_[arc].head;
  for (; nodes_[v].parent >= 0; v = arcs_[nodes_[v].parent].head)
    amount = std::min(amount, arcs_[nodes_[v].parent].capacity);
  amount = std::min(amount, -nodes_[v].excess);
  nodes_[source].excess -= amount;
  arcs_[arc].capacity -= amount;
  arcs_[arc ^ 1].capacity += amount;
  for (v = arcs_[arc].head; nodes_[v].parent >= 0;) {
    const int32_t a = nodes_[v].parent;
    arcs_[a].capacity -= amount;
    arcs_[a ^ 1].capacity += amount;
    if (arcs_[a].capacity == 0) {
      nodes_[v].parent = kOrphan;
      orphans_.push_back(v);
    }
    v = arcs_[a].head;
  }
  nodes_[v].excess += amount;
  if (nodes_[v].excess == 0) {
    nodes_[v].parent = kOrphan;
    orphans_.push_back(v);
  }
  adoptOrphans();
}

void LabelFlow::adoptOrphans() {
  ++stamp_;
  while (!orphans_.empty()) {
    const int v = orphans_.back();
    orphans_.pop_back();
    if (!findParent(v)) release(v);
  }
}

// Stores the distance, under the current stamp, in all nodes on the way.
int LabelFlow::distanceToRoot(int start) {
  int steps = 0, v = start;
  for (;; ++steps) {
    Node& node = nodes_[v];
    if (node.stamp == stamp_) {
      steps += node.distance;
      break;
    }
    if (node.parent == kOrphan) return INT32_MAX;
    if (node.parent == kRoot) {
      node.stamp = stamp_;
      node.distance = 1;
      ++steps;
      break;
    }
    v = arcs_[node.parent].head;
  }
  int distance = steps;
  for (v = start; nodes_[v].stamp != stamp_; v = arcs_[nodes_[v].parent].head) {
    nodes_[v].stamp = stamp_;
    nodes_[v].distance = distance--;
  }
  return steps;
}

bool LabelFlow::findParent(int v) {
  int best = INT32_MAX;
  int32_t parent = kFree;
  for (int32_t a = nodes_[v].first; a >= 0; a = arcs_[a].next) {
    const int u = arcs_[a].head;
    if (arcs_[a].capacity == 0 || nodes_[u].parent == kFree || nodes_[u].parent == kOrphan) continue;
    const int distance = distanceToRoot(u);
    if (distance < best) best = distance, parent = a;
  }
  if (parent == kFree) return false;
  nodes_[v].parent = parent;
  nodes_[v].stamp = stamp_;
  nodes_[v].distance = best + 1;
  return true;
}

// Removes v from the tree: its children become orphans, and neighbours that could adopt it later become active.
void LabelFlow::release(int v) {
  nodes_[v].parent = kFree;
  nodes_[v].stamp = 0;
  for (int32_t a = nodes_[v].first; a >= 0; a = arcs_[a].next) {
    Node& u = nodes_[arcs_[a].head];
    if (u.parent == kFree) continue;
    if (arcs_[a].capacity > 0) activate(arcs_[a].head);
    if (u.parent >= 0 && arcs_[u.parent].head == v) {
      u.parent = kOrphan;
      orphans_.push_back(arcs_[a].head);
    }
  }
}

}  // namespace fourdvt::bake
