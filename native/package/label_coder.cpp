// SPDX-License-Identifier: Apache-2.0
#include "package/label_coder.h"

#include "package/label_model.h"

namespace fourdvt::package {

bool decodeLabels(std::span<const uint8_t> bytes, const ChunkMesh& mesh, ChunkFrames& out) {
  BinaryDecoder decoder(bytes);
  LabelModel model(decoder, mesh, out.layer_count);
  const size_t slots = size_t(out.layer_count) * out.face_count;
  for (uint32_t f = 0; f < out.frame_count; ++f) {
    out.labels.resize((f + 1) * slots);
    model.frame(&out.labels[f * slots]);
    if (decoder.overrun()) return false;
  }
  return decoder.finished();
}

}  // namespace fourdvt::package
