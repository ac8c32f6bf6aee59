// SPDX-License-Identifier: Apache-2.0
// Predicts labels, for encoder and decoder. Exact definition: FORMAT.md, "Labels". Internal to package/.
#pragma once

#include <algorithm>
#include <cstring>

#include "package/binary_coder.h"
#include "package/character.h"
#include "package/chunk_mesh.h"

namespace fourdvt::package {

template <class Coder>
class LabelModel {
 public:
  LabelModel(Coder& coder, const ChunkMesh& mesh, uint32_t layers)
      : coder_(coder),
        mesh_(mesh),
        faces_(mesh.faceCount()),
        layers_(layers),
        face_bits_(14, 4),
        rank_bits_(16, 96),
        previous_(size_t(faces_) * layers),
        current_(previous_.size()),
        changed_(faces_),
        changed_before_(faces_) {
    for (auto& recent : recent_) {
      for (int i = 0; i < kValues; ++i) recent[i] = static_cast<uint8_t>(i < kMaxCameras ? i : kNoCamera);
    }
  }

  // Codes one frame; frames come in order. labels: [layer][face], read by an encoder, written by a decoder.
  void frame(uint8_t* labels) {
    std::swap(previous_, current_);
    std::swap(changed_before_, changed_);
    uint32_t history = 0;  // change bits of the last eight faces
    for (uint32_t f = 0; f < faces_; ++f) {
      uint8_t* tuple = &current_[size_t(f) * layers_];
      for (uint32_t l = 0; l < layers_; ++l) tuple[l] = labels[size_t(l) * faces_ + f];
      changed_[f] = temporal_ && faceChanged(f, tuple, history);
      history = (history << 1 | (changed_[f] != 0)) & 255;
      if (temporal_ && !changed_[f])
        std::memcpy(tuple, previousOf(f), layers_);
      else
        codeTuple(f, tuple);
      for (uint32_t l = 0; l < layers_; ++l) labels[size_t(l) * faces_ + f] = tuple[l];
    }
    temporal_ = true;
  }

 private:
  static constexpr int kValues = kMaxCameras + 1;
  const uint8_t* previousOf(uint32_t f) const { return &previous_[size_t(f) * layers_]; }
  const uint8_t* currentOf(uint32_t f) const { return &current_[size_t(f) * layers_]; }
  bool sameTuple(const uint8_t* a, const uint8_t* b) const { return std::memcmp(a, b, layers_) == 0; }

  [[gnu::flatten]] bool faceChanged(uint32_t f, const uint8_t* tuple, uint32_t history) {
    const uint8_t* before = previousOf(f);
    std::array<uint32_t, 3> states;
    uint32_t changes = 0, earlier_changes = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t g = mesh_.face_neighbours[f][k];
      states[k] = 0;
      if (g == kNoFace) continue;
      const uint32_t differs = !sameTuple(previousOf(g), before);
      earlier_changes += changed_before_[g];
      states[k] = 5 + differs;
      if (g >= f) continue;
      changes += changed_[g];
      states[k] = 1 + 2 * changed_[g] + differs;
      if (changed_[g] && sameTuple(currentOf(g), before)) states[k] = 7;
    }
    std::sort(states.begin(), states.end());
    const uint32_t around = states[0] * 64 + states[1] * 8 + states[2];
    return face_bits_.code(coder_, !sameTuple(tuple, before),
                           {around, history * 4 + changes, (changed_before_[f] * 4 + earlier_changes) * 512 + around},
                           changes);
  }

  void codeTuple(uint32_t f, uint8_t* tuple) {
    uint32_t changed_ranks = 0;
    for (uint32_t l = 0; l < layers_; ++l) {
      tuple[l] = codeRank(f, l, changed_ranks);
      if (temporal_ && tuple[l] != previousOf(f)[l]) changed_ranks |= 1u << l;
      auto& recent = recent_[l];
      std::rotate(recent.begin(), std::find(recent.begin(), recent.end() - 1, tuple[l]), recent.end());
    }
  }

  // Lists the possible labels of rank l, each once, likely ones first; returns their number.
  int listCandidates(uint32_t f, uint32_t l, std::array<uint8_t, kValues>& out) const {
    uint32_t seen = 0;
    int count = 0;
    const auto add = [&](uint8_t label) {
      const uint32_t bit = 1u << (label & 31);  // kNoCamera: bit 31
      if (!(seen & bit)) out[count++] = label;
      seen |= bit;
    };
    const auto& neighbours = mesh_.face_neighbours[f];
    if (temporal_) {
      add(previousOf(f)[l]);
      for (uint32_t g : neighbours) {
        if (g < f && currentOf(g)[l] != previousOf(g)[l]) add(currentOf(g)[l]);
      }
    }
    for (uint32_t g : neighbours) {
      if (g < f) add(currentOf(g)[l]);
    }
    if (temporal_) {
      for (uint32_t g : neighbours) {
        if (g >= f && g != kNoFace) add(previousOf(g)[l]);
      }
      for (uint32_t j = 0; j < layers_; ++j) add(previousOf(f)[j]);
    }
    for (uint32_t g : neighbours) {
      for (uint32_t j = 0; g < f && j < layers_; ++j) add(currentOf(g)[j]);
    }
    for (uint8_t label : recent_[l]) add(label);
    return count;
  }

  uint8_t codeRank(uint32_t f, uint32_t l, uint32_t changed_ranks) {
    std::array<uint8_t, kValues> candidates;
    const int count = listCandidates(f, l, candidates);
    for (int r = 0; r + 1 < count; ++r) {
      if (codeCandidate(f, l, changed_ranks, candidates[r], std::min(r, 5))) return candidates[r];
    }
    return candidates[count - 1];
  }

  // Codes "the label of rank l of face f is x", x being candidate number `number`; lower ranks are coded already.
  [[gnu::flatten]] bool codeCandidate(uint32_t f, uint32_t l, uint32_t changed_ranks, uint8_t x, uint32_t number) {
    const uint8_t *tuple = currentOf(f), *before = previousOf(f);
    uint32_t used = 0, displaced = 0, came_from = 0;
    for (uint32_t j = 0; j < l; ++j) {
      used |= tuple[j] == x && x != kNoCamera;
      displaced |= temporal_ && tuple[j] == before[l] && tuple[j] != kNoCamera;
    }
    for (uint32_t j = layers_; temporal_ && j-- > 0;) {  // lowest rank that held x
      if (before[j] == x) came_from = j < l ? 1 + !(changed_ranks >> j & 1) : j == l ? 3 : 4;
    }
    std::array<uint32_t, 3> states;
    uint32_t ranks_with_x = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t g = mesh_.face_neighbours[f][k];
      states[k] = 6;
      if (g == kNoFace || (g >= f && !temporal_)) continue;
      const bool now = currentOf(g)[l] == x, then = temporal_ ? previousOf(g)[l] == x : now;
      states[k] = g < f ? (now ? !then : 2 + !then) : 4 + !then;
      const uint8_t* known = g < f ? currentOf(g) : previousOf(g);
      for (uint32_t j = 0; j < layers_; ++j) ranks_with_x |= uint32_t(known[j] == x) << j;
    }
    std::sort(states.begin(), states.end());
    const uint32_t around = states[0] * 49 + states[1] * 7 + states[2];
    const uint32_t base = (l * 2 + temporal_) * 8 + number;
    const uint32_t label_before = l > 0 ? tuple[l - 1] : 254;
    return rank_bits_.code(
        coder_, tuple[l] == x,
        {(base * 343 + around) * 2 + used, (((base * 64 + changed_ranks) * 2 + used) * 8 + came_from) * 2 + displaced,
         (base * 256 + x) * 256 + (temporal_ ? before[l] : 255), ((base * 256 + x) * 256 + label_before) * 2 + used,
         ((base * 64 + ranks_with_x) * 8 + came_from) * 2 + (changed_ranks != 0)},
        (temporal_ * 8 + l) * 6 + number);
  }

  Coder& coder_;
  const ChunkMesh& mesh_;
  const uint32_t faces_, layers_;
  bool temporal_ = false;  // false in a chunk's first frame
  MixedBit<3> face_bits_;
  MixedBit<5> rank_bits_;
  std::vector<uint8_t> previous_, current_;                      // [face][layer]
  std::vector<uint8_t> changed_, changed_before_;                // [face], 0 or 1: in this frame, in the frame before
  std::array<std::array<uint8_t, kValues>, kMaxLayers> recent_;  // [layer], most recent first
};

}  // namespace fourdvt::package
