// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/window.h"

#include <algorithm>
#include <utility>

namespace fourdvt::bake {
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

// Takes the neighbouring frame's cameras where they are still feasible, and fills the remaining ranks with the
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

// Makes a first guess for every frame without labels: from the frame before, or by solving one frame by itself.
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
