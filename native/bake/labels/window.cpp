// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/window.h"

#include <algorithm>
#include <utility>

namespace fourdvt::bake {
namespace {

void labelByPenalty(const FaceCosts& costs, int layers, std::vector<LabelTuple>& labels) {
  labels.resize(costs.feasible.size());
  for (size_t f = 0; f < labels.size(); ++f) labels[f] = cheapestCameras(costs, f, costs.feasible[f], layers);
}

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

// 4DVT 4.1: solves layer after layer; a camera that a face has taken is not allowed in its further layers.
void solveLayers(const LabelOptions& options, float tau, const FaceLinks& links, std::vector<WindowFrame>& frames) {
  const LabelWeights weights = LabelWeights::singleLayer(tau, options.empty_penalty, links);
  std::vector<std::vector<uint32_t>> allowed(frames.size());
  std::vector<std::vector<LabelTuple>> layer(frames.size());
  for (size_t k = 0; k < frames.size(); ++k) {
    layer[k].resize(links.faceCount());
    if (frames[k].frozen) continue;
    allowed[k] = frames[k].costs->feasible;
    frames[k].labels->resize(links.faceCount());
  }
  for (int l = 0; l < options.layers; ++l) {
    std::vector<BlockFrame> block;
    for (size_t k = 0; k < frames.size(); ++k) {
      const WindowFrame& frame = frames[k];
      for (uint32_t f = 0; f < links.faceCount(); ++f) {
        uint8_t camera = (*frame.labels)[f].ranks[l];
        if (!frame.frozen && (camera == package::kNoCamera || !(allowed[k][f] >> camera & 1)))
          camera = cheapestCameras(*frame.costs, f, allowed[k][f], 1).ranks[0];
        layer[k][f].ranks[0] = camera;
      }
      block.push_back({frame.costs, frame.frozen ? nullptr : &allowed[k], &layer[k], frame.frozen, false});
    }
    ExpansionBlock(weights, links, std::move(block)).solve(options.sweeps);
    for (size_t k = 0; k < frames.size(); ++k) {
      if (frames[k].frozen) continue;
      for (uint32_t f = 0; f < links.faceCount(); ++f) {
        const uint8_t camera = layer[k][f].ranks[0];
        (*frames[k].labels)[f].ranks[l] = camera;
        if (camera != package::kNoCamera) allowed[k][f] &= ~(1u << camera);
      }
    }
  }
}

}  // namespace

void solveWindow(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames) {
  switch (options.mode) {
    case LabelMode::Naive:
    case LabelMode::PerTexel:
      for (WindowFrame& frame : frames) labelByPenalty(*frame.costs, options.layers, *frame.labels);
      return;
    case LabelMode::Spatial:
      return solveLayers(options, 0, links, frames);
    case LabelMode::TemporalPaper:
      return solveLayers(options, 1.0f / links.faceCount(), links, frames);
    case LabelMode::Joint:
      return solveJoint(options, links, frames);
  }
}

}  // namespace fourdvt::bake
