// SPDX-License-Identifier: Apache-2.0
#include "render/appearance.h"

#include <cassert>

#include "render/shared_corners.h"
#include "render/table.h"

namespace fourdvt::render {

Result<Appearance> Appearance::create(gpu::Device& device, const CharacterModel& model, int member_count) {
  if (member_count < 1 || member_count > package::kMaxMembers)
    return Error{ErrorId::InvalidArgument, "an appearance has 1 to " + std::to_string(package::kMaxMembers) +
                                               " members, not " + std::to_string(member_count)};
  const uint64_t vertices = model.vertex_count, faces = model.face_count;
  if (tableRows(member_count * std::max(vertices, faces)) > static_cast<uint32_t>(device.caps().max_texture_size))
    return Error{ErrorId::GpuFailure, "the class's " + std::to_string(member_count) +
                                          " motions have too many faces for this GPU; bake a coarser mesh"};
  Appearance appearance;
  appearance.member_count = member_count;
  appearance.layer_count = model.layer_count;
  const auto table = [&](gpu::Texture& out, gpu::PixelFormat format, uint64_t texels, const char* label) -> Status {
    FOURDVT_ASSIGN(out, makeTable(device, format, texels, label));
    return {};
  };
  FOURDVT_TRY(table(appearance.vertex_masks, gpu::PixelFormat::R32UI, member_count * vertices, "vertex camera masks"));
  FOURDVT_TRY(table(appearance.labels, gpu::PixelFormat::R32UI, member_count * faces, "face labels"));
  if (member_count > 1)
    FOURDVT_TRY(table(appearance.alignment, gpu::PixelFormat::RG32F, (member_count - 1) * vertices, "alignment"));
  appearance.corners = gpu::makeIndexBuffer(device);
  return appearance;
}

void Appearance::setFrame(gpu::Device& device, const CharacterModel& model, const FrameAppearance& frame) {
  const size_t vertices = model.vertex_count, faces = model.face_count, member_labels = layer_count * faces;
  assert(frame.labels.size() == member_count * member_labels);
  assert(frame.alignment.empty() || frame.alignment.size() == (member_count - 1) * vertices);
  resizeToRows(masks_, member_count * vertices, ~0u);
  resizeToRows(packed_, member_count * faces, ~0u);
  for (int member = 0; member < member_count; ++member)
    packLabels(model.faces(), frame.labels.subspan(member * member_labels, member_labels), model.camera_count,
               std::span(packed_).subspan(member * faces, faces),
               std::span(masks_).subspan(member * vertices, vertices));
  uploadTable(device, vertex_masks, masks_);
  uploadTable(device, labels, packed_);
  shareCorners(model.cornersBefore(), model.faces(), std::span(packed_).first(member_count * faces), corners_);
  device.updateIndices(corners.id(), corners_);
  aligned = !frame.alignment.empty();
  if (aligned) {
    resizeToRows(displacements_, frame.alignment.size(), glm::vec2(0));
    std::copy(frame.alignment.begin(), frame.alignment.end(), displacements_.begin());
    uploadTable(device, alignment, displacements_);
  }
  frame_set_ = true;
}

void Appearance::setLayout(const package::Rendition& rendition) {
  picture_size = {rendition.width, rendition.height};
  layer_rects_uv.clear();
  for (const package::Rect& rect : rendition.layers)
    layer_rects_uv.emplace_back(glm::vec2(rect.x, rect.y) / picture_size,
                                glm::vec2(rect.width, rect.height) / picture_size);
}

}  // namespace fourdvt::render
