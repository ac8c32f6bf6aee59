// SPDX-License-Identifier: Apache-2.0
#include "package/label_coder.h"
#include "package/label_model.h"

namespace fourdvt::package {

std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member) {
  BinaryEncoder encoder;
  LabelModel model(encoder, mesh, frames.layer_count);
  const size_t labels_per_member = size_t(frames.layer_count) * frames.face_count;
  std::vector<uint8_t> labels = frames.labels;
  for (uint32_t f = 0; f < frames.frame_count; ++f)
    model.frame(&labels[(size_t(f) * frames.member_count + member) * labels_per_member]);
  return encoder.take();
}

}  // namespace fourdvt::package
