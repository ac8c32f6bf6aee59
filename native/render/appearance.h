// SPDX-License-Identifier: Apache-2.0
// Texture appearance of one decoded picture on a mesh: labels, seam masks and alignment of each member, and its layers'
// rectangles in the picture. A plain sequence has one member; a class up to package::kMaxMembers, all in one picture.
// Drawn on the mesh of a CharacterModel, which several appearances may share during a transition.
#pragma once

#include <span>
#include <vector>

#include "render/character_model.h"

namespace fourdvt::render {

struct FrameAppearance {
  std::span<const uint8_t> labels;       // [member][layer][face]; kNoCamera for empty
  std::span<const glm::vec2> alignment;  // [member - 1][vertex], metres along the tangents; empty: no alignment
};

class Appearance {
 public:
  // Errors: GpuFailure, InvalidArgument.
  static Result<Appearance> create(gpu::Device& device, const CharacterModel& model, int member_count);
  // Uploads labels, alignment and the per-vertex camera masks of seam feathering (bit c of a vertex: camera c is in the
  // label set of every incident face; algorithms/rendering.md).
  void setFrame(gpu::Device& device, const CharacterModel& model, const FrameAppearance& frame);
  // Sets a rendition's tile layout, members × layers rectangles; required before drawing.
  void setLayout(const package::Rendition& rendition);
  // True after setFrame, and setLayout with member_count × layer_count rectangles.
  bool ready() const { return frame_set_ && layer_rects_uv.size() == size_t(member_count) * size_t(layer_count); }

  // Tables bound by LayeredPass, addressed like CharacterModel's.
  gpu::Texture vertex_masks;              // R32UI, member_count × vertex_count
  gpu::Texture labels;                    // R32UI, member_count × face_count: 5 bits per rank, 31 = empty
  gpu::Texture alignment;                 // RG32F, (member_count - 1) × vertex_count; none with one member
  gpu::IndexBuffer corners;               // corners shared among faces with equal labels (shared_corners.h)
  std::vector<glm::vec4> layer_rects_uv;  // [member][layer] x, y, width, height; picture texture coordinates
  glm::vec2 picture_size{1};
  int member_count = 1, layer_count = 0;
  bool aligned = false;  // the current frame has alignment
  // Correlation of the aligned members' finest structure, 0..1; sets the contrast that an aligned blend restores.
  float detail_correlation = 1;

 private:
  bool frame_set_ = false;
  std::vector<uint32_t> masks_, packed_, corners_;  // scratch
  std::vector<glm::vec2> displacements_;            // scratch
};

}  // namespace fourdvt::render
