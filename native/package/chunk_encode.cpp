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

bool countsMatch(const ChunkFrames& in, const ChunkMesh& mesh) {
  const size_t frames = in.frame_count, members = frames * in.member_count;
  return frames > 0 && in.vertex_count == mesh.vertexCount() && in.face_count == mesh.faceCount() && validCounts(in) &&
         in.positions.size() == members * in.vertex_count &&
         in.labels.size() == members * in.layer_count * in.face_count &&
         in.offsets.size() == frames * in.reference_count * in.vertex_count &&
         in.alignment.size() == frames * in.alignment_count * in.vertex_count && in.root.size() == members;
}

// Leaves room for the error that a residual step permits.
bool fits(const glm::ivec3& q, uint32_t step) {
  const glm::ivec3 error(static_cast<int>(step) - 1);
  return inRange(q) && inRange(q - error) && inRange(q + error);
}

bool valuesFit(const ChunkFrames& in, ResidualSteps steps) {
  const auto fit = [&](const glm::ivec3& q) { return fits(q, steps.positions); };
  return std::all_of(in.positions.begin(), in.positions.end(), fit) &&
         std::all_of(in.offsets.begin(), in.offsets.end(), fit) &&
         std::all_of(in.alignment.begin(), in.alignment.end(),
                     [&](const glm::ivec2& q) { return fits(glm::ivec3(q, 0), steps.alignment); }) &&
         std::all_of(in.root.begin(), in.root.end(), validRoot) &&
         std::all_of(in.labels.begin(), in.labels.end(),
                     [](uint8_t label) { return label < kMaxCameras || label == kNoCamera; });
}

// Encodes one part of mesh-blend corrections or alignment: field `field` of `count`. fields: [frame][field][vertex].
template <int N>
std::vector<uint8_t> encodeField(std::vector<glm::vec<N, int>> fields, const ChunkFrames& frames, uint32_t count,
                                 uint32_t field, const ChunkMesh& mesh, uint32_t residual_step) {
  BinaryEncoder encoder;
  FieldModel model(encoder, mesh, N, residual_step);
  for (uint32_t f = 0; f < frames.frame_count; ++f)
    model.frame(&fields[(size_t(f) * count + field) * frames.vertex_count]);
  ByteWriter out;
  out.u32(residual_step);
  out.bytes(encoder.take());
  return out.take();
}

// Scale from the base pose's lattice to the stream's steps: ratio of distances between neighbours in frame 0 and in the
// base pose, since they hardly change between poses.
PositionScale positionScale(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member, uint32_t residual_step) {
  const glm::ivec3* positions = &frames.positions[size_t(member) * frames.vertex_count];
  double steps = 0, lattice = 0;
  for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    for (uint32_t u : mesh.earlierOf(v).first(mesh.ring_count[v])) {
      const glm::dvec3 a(positions[v] - positions[u]), b(mesh.base[v] - mesh.base[u]);
      steps += glm::dot(a, a);
      lattice += glm::dot(b, b);
    }
  }
  const double scale = lattice > 0 ? std::sqrt(steps / lattice) * 65536 : 0;
  return {static_cast<uint32_t>(std::min(scale + 0.5, 4294967295.0)), residual_step};
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

namespace {

std::vector<uint8_t> encodeScaled(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                  const PositionScale& scale) {
  std::vector<glm::ivec3> positions(frames.vertex_count);
  BinaryEncoder encoder;
  PositionModel model(encoder, mesh, scale);
  for (uint32_t f = 0; f < frames.frame_count; ++f) {
    const auto frame = frames.positions.begin() + (size_t(f) * frames.member_count + member) * frames.vertex_count;
    std::copy(frame, frame + frames.vertex_count, positions.begin());
    model.frame(positions.data());
  }
  ByteWriter out;
  out.u32(scale.base_scale);
  out.u32(scale.residual_step);
  out.bytes(encoder.take());
  return out.take();
}

}  // namespace

std::vector<uint8_t> encodePositions(const ChunkFrames& frames, const ChunkMesh& mesh, uint32_t member,
                                     uint32_t residual_step) {
  return encodeScaled(frames, mesh, member, positionScale(frames, mesh, member, residual_step));
}

namespace {

struct ChunkSteps {
  std::vector<PositionScale> positions;  // [member]
  std::vector<uint32_t> fields;          // residual steps of corrections, then of alignment
};

// Encodes a chunk whose counts and values are checked.
std::vector<uint8_t> encode(const ChunkFrames& frames, const ChunkMesh& mesh, const ChunkSteps& steps) {
  std::vector<std::vector<uint8_t>> parts;
  for (uint32_t m = 0; m < frames.member_count; ++m) {
    parts.push_back(encodeScaled(frames, mesh, m, steps.positions[m]));
    parts.push_back(encodeLabels(frames, mesh, m));
  }
  auto step = steps.fields.begin();
  for (uint32_t r = 0; r < frames.reference_count; ++r)
    parts.push_back(encodeField<3>(frames.offsets, frames, frames.reference_count, r, mesh, *step++));
  for (uint32_t a = 0; a < frames.alignment_count; ++a)
    parts.push_back(encodeField<2>(frames.alignment, frames, frames.alignment_count, a, mesh, *step++));
  ByteWriter out;
  for (const auto& part : parts) out.u32(static_cast<uint32_t>(part.size()));
  for (const auto& part : parts) out.bytes(part);
  for (const glm::vec3& root : frames.root) {
    for (int k = 0; k < 3; ++k) out.f32(root[k]);
  }
  return out.take();
}

ChunkSteps stepsOf(std::span<const uint8_t> chunk, const ChunkFrames& counts) {
  ByteReader lengths(chunk), in(chunk);
  in.bytes(size_t(4) * partCount(counts));
  const auto next = [&] { return ByteReader(in.bytes(lengths.u32())); };
  ChunkSteps out;
  for (uint32_t m = 0; m < counts.member_count; ++m) {
    ByteReader part = next();
    PositionScale& scale = out.positions.emplace_back();
    scale.base_scale = part.u32();
    scale.residual_step = part.u32();
    next();  // labels
  }
  for (uint32_t i = 0; i < counts.reference_count + counts.alignment_count; ++i) out.fields.push_back(next().u32());
  return out;
}

}  // namespace

Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames, const ChunkMesh& mesh, ResidualSteps steps) {
  if (!countsMatch(frames, mesh)) return Error{ErrorId::Internal, "GOP chunk: counts do not match its contents"};
  if (!validResidualStep(steps.positions) || !validResidualStep(steps.alignment))
    return Error{ErrorId::Internal, "GOP chunk: a residual step is out of range"};
  if (!valuesFit(frames, steps)) return Error{ErrorId::Internal, "GOP chunk: a value is out of range"};
  ChunkSteps parts;
  for (uint32_t m = 0; m < frames.member_count; ++m)
    parts.positions.push_back(positionScale(frames, mesh, m, steps.positions));
  parts.fields.assign(frames.reference_count, steps.positions);
  parts.fields.resize(size_t(frames.reference_count) + frames.alignment_count, steps.alignment);
  return encode(frames, mesh, parts);
}

Result<std::vector<uint8_t>> encodeFirstFrame(std::span<const uint8_t> chunk, const ChunkFrames& first,
                                              const ChunkMesh& mesh) {
  if (!countsMatch(first, mesh)) return Error{ErrorId::Internal, "GOP chunk: counts do not match its contents"};
  return encode(first, mesh, stepsOf(chunk, first));
}

}  // namespace fourdvt::package
