// SPDX-License-Identifier: Apache-2.0
#include "package/chunk_encode.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "package/character.h"
#include "package/chunk_counts.h"
#include "package/field_model.h"
#include "package/label_model.h"
#include "package/position_model.h"
#include "package/residual_model.h"

namespace fourdvt::package {
namespace {

// Dead zone, in steps: residuals below it become 0, larger ones lose up to this. Halves the bytes against rounding, at
// errors at most 0.3 steps larger.
constexpr double kDeadZone = 0.8;

// value: in the stream's fine steps; predicted and result: in steps `scale` times as large.
template <int N>
glm::ivec3 coarseResidual(const glm::vec<N, int>& value, double scale, const glm::ivec3& predicted) {
  glm::ivec3 out(0);
  for (int k = 0; k < N; ++k) {
    const double residual = value[k] / scale - predicted[k];
    const int magnitude = static_cast<int>(std::floor(std::abs(residual) + (1 - kDeadZone)));
    out[k] = residual < 0 ? -magnitude : magnitude;
  }
  return out;
}

bool countsMatch(const ChunkFrames& in, const ChunkMesh& mesh) {
  const size_t frames = in.frame_count, members = frames * in.member_count;
  return frames > 0 && in.vertex_count == mesh.vertexCount() && in.face_count == mesh.faceCount() && validCounts(in) &&
         in.positions.size() == members * in.vertex_count &&
         in.labels.size() == members * in.layer_count * in.face_count &&
         in.offsets.size() == frames * in.reference_count * in.vertex_count &&
         in.alignment.size() == frames * in.alignment_count * in.vertex_count && in.root.size() == members;
}

bool valuesFit(const ChunkFrames& in) {
  return std::all_of(in.positions.begin(), in.positions.end(), inRange) &&
         std::all_of(in.offsets.begin(), in.offsets.end(), inRange) &&
         std::all_of(in.alignment.begin(), in.alignment.end(),
                     [](const glm::ivec2& q) { return inRange(glm::ivec3(q, 0)); }) &&
         std::all_of(in.root.begin(), in.root.end(), validRoot) &&
         std::all_of(in.labels.begin(), in.labels.end(),
                     [](uint8_t label) { return label < kMaxCameras || label == kNoCamera; });
}

// Encodes one part of mesh-blend corrections or alignment: field `field` of `count`. fields: [frame][field][vertex].
template <int N>
std::vector<uint8_t> encodeField(std::vector<glm::vec<N, int>> fields, const ChunkFrames& frames, uint32_t count,
                                 uint32_t field, const ChunkMesh& mesh, double coarse_scale) {
  BinaryEncoder encoder;
  FieldModel model(encoder, mesh, N);
  for (uint32_t f = 0; f < frames.frame_count; ++f) {
    glm::vec<N, int>* values = &fields[(size_t(f) * count + field) * frames.vertex_count];
    if (coarse_scale == 0)
      model.frame(values);
    else
      model.frame(values, [&](uint32_t v, const glm::ivec3& p) { return coarseResidual(values[v], coarse_scale, p); });
  }
  return encoder.take();
}

// Scale from the base pose's lattice to the stream's steps (`step`, of the positions): ratio of edge lengths in frame 0
// and in the base pose, since edge lengths hardly change between poses.
uint32_t baseScale(const glm::ivec3* positions, const ChunkMesh& mesh, double step) {
  double steps = 0, lattice = 0;
  for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    for (uint32_t u : mesh.earlierOf(v).first(mesh.ring_count[v])) {
      const glm::dvec3 a(positions[v] - positions[u]), b(mesh.base[v] - mesh.base[u]);
      steps += glm::dot(a, a);
      lattice += glm::dot(b, b);
    }
  }
  const double scale = lattice > 0 ? std::sqrt(steps / lattice) / step * 65536 : 0;
  return static_cast<uint32_t>(std::min(scale + 0.5, 4294967295.0));
}

}  // namespace

std::vector<uint8_t> encodeLabels(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member) {
  BinaryEncoder encoder;
  LabelModel model(encoder, mesh, frames.layer_count);
  const size_t labels_per_member = size_t(frames.layer_count) * frames.face_count;
  std::vector<uint8_t> labels = frames.labels;
  for (uint32_t f = 0; f < frames.frame_count; ++f)
    model.frame(&labels[(size_t(f) * frames.member_count + member) * labels_per_member]);
  return encoder.take();
}

std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     double coarse_scale) {
  const size_t first = size_t(member) * frames.vertex_count, stride = size_t(frames.member_count) * frames.vertex_count;
  std::vector<glm::ivec3> positions = frames.positions;
  const bool coarse = coarse_scale > 0;
  const uint32_t base_scale = baseScale(&positions[first], mesh, coarse ? coarse_scale : 1);
  BinaryEncoder encoder;
  PositionModel model(encoder, mesh, base_scale);
  for (uint32_t f = 0; f < frames.frame_count; ++f) {
    glm::ivec3* frame = &positions[f * stride + first];
    if (!coarse)
      model.frame(frame);
    else
      model.frame(frame, [&](uint32_t v, const glm::ivec3& p) { return coarseResidual(frame[v], coarse_scale, p); });
  }
  ByteWriter out;
  out.u32(base_scale);
  out.bytes(encoder.take());
  return out.take();
}

namespace {

// coarse_scale: 0 encodes the frames exactly.
Result<std::vector<uint8_t>> encode(const ChunkFrames& frames, const ChunkMesh& mesh, double coarse_scale) {
  if (!countsMatch(frames, mesh)) return Error{ErrorId::Internal, "GOP chunk: counts do not match its contents"};
  if (!valuesFit(frames)) return Error{ErrorId::Internal, "GOP chunk: a value is out of range"};
  std::vector<std::vector<uint8_t>> parts;
  for (uint32_t m = 0; m < frames.member_count; ++m) {
    parts.push_back(encodePositions(frames, mesh, m, coarse_scale));
    parts.push_back(encodeLabels(frames, mesh, m));
  }
  for (uint32_t r = 0; r < frames.reference_count; ++r)
    parts.push_back(encodeField<3>(frames.offsets, frames, frames.reference_count, r, mesh, coarse_scale));
  for (uint32_t a = 0; a < frames.alignment_count; ++a)
    parts.push_back(encodeField<2>(frames.alignment, frames, frames.alignment_count, a, mesh, coarse_scale));
  ByteWriter out;
  for (const auto& part : parts) out.u32(static_cast<uint32_t>(part.size()));
  for (const auto& part : parts) out.bytes(part);
  for (const glm::vec3& root : frames.root) {
    for (int k = 0; k < 3; ++k) out.f32(root[k]);
  }
  return out.take();
}

}  // namespace

Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames, const ChunkMesh& mesh) {
  return encode(frames, mesh, 0);
}

Result<std::vector<uint8_t>> encodeCoarseChunk(const ChunkFrames& frames, const ChunkMesh& mesh, double scale) {
  if (!(scale >= 1)) return Error{ErrorId::Internal, "GOP chunk: coarse steps must not be smaller"};
  return encode(frames, mesh, scale);
}

}  // namespace fourdvt::package
