// SPDX-License-Identifier: Apache-2.0
// What one decoded picture shows on a mesh: labels, seam masks and alignment of each member, and where their layers lie
// in the picture. A plain sequence has one member; a class up to package::kMaxMembers, all in one picture.
// It is drawn on the mesh of a CharacterModel, which several appearances may share (in a transition).
#pragma once

#include <span>
#include <vector>

#include "render/character_model.h"

namespace fourdvt::render {

struct FrameAppearance {
  std::span<const uint8_t> labels;       // [member][layer][face]; kNoCamera for empty
  std::span<const glm::vec2> alignment;  // [member - 1][vertex], metres along the tangents; empty: not aligned
};

class Appearance {
 public:
  // Errors: GpuFailure, InvalidArgument.
  static Result<Appearance> create(gpu::Device& device, const CharacterModel& model, int member_count);
  // Uploads labels, the per-vertex camera masks of seam feathering (bit c of a vertex: camera c is in the label set of
  // every incident face; algorithms/rendering.md) and alignment.
  void setFrame(gpu::Device& device, const CharacterModel& model, const FrameAppearance& frame);
  // Takes a rendition's tile layout, members × layers rectangles; needed before drawing.
  void setLayout(const package::Rendition& rendition);
  // True once setFrame was called, and setLayout with as many rectangles as there are layers.
  bool ready() const { return frame_set_ && layer_rects_uv.size() == size_t(member_count) * size_t(layer_count); }

  // What LayeredPass binds; tables are addressed as CharacterModel's are.
  gpu::Texture vertex_masks;              // R32UI, member_count × vertex_count
  gpu::Texture labels;                    // R32UI, member_count × face_count: 5 bits per rank, 31 = empty
  gpu::Texture alignment;                 // RG32F, (member_count - 1) × vertex_count; none with one member
  gpu::IndexBuffer corners;               // of faces with the same labels shared (shared_corners.h)
  std::vector<glm::vec4> layer_rects_uv;  // [member][layer] x, y, width, height in picture texture coordinates
  glm::vec2 picture_size{1};
  int member_count = 1, layer_count = 0;
  bool aligned = false;  // the frame set last has alignment
  // Correlation of the aligned members' finest structure, 0..1: how much contrast an aligned blend has to get back.
  float detail_correlation = 1;

 private:
  bool frame_set_ = false;
  std::vector<uint32_t> masks_, packed_, corners_;  // scratch
  std::vector<glm::vec2> displacements_;            // scratch
};

}  // namespace fourdvt::render
