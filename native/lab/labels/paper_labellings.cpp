// SPDX-License-Identifier: Apache-2.0
#include "lab/labels/paper_labellings.h"

#include <array>

#include "bake/labels/expansion.h"
#include "lab/labels/per_texel.h"

namespace fourdvt::lab {
namespace {

using bake::BlockFrame;
using bake::cheapestCameras;
using bake::ExpansionBlock;
using bake::FaceLinks;
using bake::LabelOptions;
using bake::LabelTuple;
using bake::LabelWeights;
using bake::WindowFrame;

LabelWeights singleLayer(float tau, float empty_penalty, const FaceLinks& links) {
  LabelOptions options;
  options.layers = 1;
  options.theta = options.omega = {1.0f};
  options.eta = 0;
  options.tau = tau;
  options.empty_penalty = empty_penalty;
  return LabelWeights::joint(options, links);
}

// Solves layer after layer (Casas et al. 2014, 4.1); excludes a face's earlier cameras from its further layers.
void solveLayers(const LabelOptions& options, float tau, const FaceLinks& links, std::vector<WindowFrame>& frames) {
  const LabelWeights weights = singleLayer(tau, options.empty_penalty, links);
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

void solveNaive(const LabelOptions& options, const FaceLinks&, std::vector<WindowFrame>& frames) {
  for (WindowFrame& frame : frames) labelByPenalty(*frame.costs, options.layers, *frame.labels);
}

void solveSpatial(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames) {
  solveLayers(options, 0, links, frames);
}

void solveTemporalPaper(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames) {
  solveLayers(options, 1.0f / links.faceCount(), links, frames);
}

}  // namespace

const bake::Labelling kNaive{"naive", false, solveNaive};
const bake::Labelling kSpatial{"spatial", false, solveSpatial};
const bake::Labelling kTemporalPaper{"temporal-paper", true, solveTemporalPaper};
const bake::Labelling kPerTexel{"per-texel", false, solveNaive};

std::span<const bake::Labelling* const> allLabellings() {
  static const std::array<const bake::Labelling*, 5> all{&kNaive, &kSpatial, &kTemporalPaper, &bake::kJoint,
                                                         &kPerTexel};
  return all;
}

const bake::Labelling* findLabelling(std::string_view name) {
  for (const bake::Labelling* rule : allLabellings())
    if (name == rule->name) return rule;
  return nullptr;
}

void useLabelling(const bake::Labelling& rule, bake::BakeOptions& options) {
  options.labels = &rule;
  options.texel_rule = &rule == &kPerTexel ? resamplePerTexel : nullptr;
}

}  // namespace fourdvt::lab
