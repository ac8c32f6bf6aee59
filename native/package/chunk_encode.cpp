// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "base/bytes.h"
#include "draco/compression/expert_encode.h"
#include "draco/point_cloud/point_cloud.h"
#include "package/character.h"
#include "package/chunk_symbols.h"
#include "package/stream_file.h"

namespace fourdvt::package {
namespace {

// values: [attribute][point][component]
Result<std::vector<uint8_t>> encodePointCloud(const std::vector<std::vector<int32_t>>& values, uint32_t points,
                                              int components, int prediction) {
  draco::PointCloud cloud;
  cloud.set_num_points(points);
  for (const std::vector<int32_t>& attribute_values : values) {
    draco::GeometryAttribute attribute;
    attribute.Init(draco::GeometryAttribute::GENERIC, nullptr, static_cast<uint8_t>(components), draco::DT_INT32, false,
                   components * sizeof(int32_t), 0);
    const int id = cloud.AddAttribute(attribute, true, points);
    for (uint32_t p = 0; p < points; ++p) {
      cloud.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p), &attribute_values[size_t(p) * components]);
    }
  }
  draco::ExpertEncoder encoder(cloud);
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(0, 0);
  draco::EncoderBuffer buffer;
  draco::Status status;
  for (size_t a = 0; a < values.size() && status.ok(); ++a) {
    status = encoder.SetAttributePredictionScheme(static_cast<int32_t>(a), prediction);
  }
  if (status.ok()) status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) return Error{ErrorId::Internal, "GOP chunk: Draco: " + status.error_msg_string()};
  return std::vector<uint8_t>(buffer.data(), buffer.data() + buffer.size());
}

Result<std::vector<uint8_t>> encodePositions(const ChunkFrames& in) {
  std::vector<std::vector<int32_t>> residuals(in.frame_count);
  for (uint32_t f = 0; f < in.frame_count; ++f) {
    for (uint32_t v = 0; v < in.vertex_count; ++v) {
      const glm::ivec3 actual = in.positions[size_t(f) * in.vertex_count + v];
      const glm::ivec3 residual(glm::uvec3(actual) - predictedPosition(in.positions.data(), f, v, in.vertex_count));
      residuals[f].insert(residuals[f].end(), {residual.x, residual.y, residual.z});
    }
  }
  return encodePointCloud(residuals, in.vertex_count, 3, draco::PREDICTION_DIFFERENCE);
}

using Tuple = uint64_t;  // 8 bits a layer, layer 0 lowest
static_assert(kMaxLayers <= 8);

Tuple tupleOf(const ChunkFrames& in, uint32_t frame, uint32_t face) {
  Tuple tuple = 0;
  for (uint32_t l = 0; l < in.layer_count; ++l) {
    tuple |= Tuple(in.labels[(size_t(frame) * in.layer_count + l) * in.face_count + face]) << (8 * l);
  }
  return tuple;
}

// Distinct tuples, most frequent first, as rank and as planar bytes.
std::map<Tuple, int32_t> buildPalette(const ChunkFrames& in, std::vector<uint8_t>& bytes) {
  std::map<Tuple, uint32_t> counts;
  for (uint32_t f = 0; f < in.frame_count; ++f) {
    for (uint32_t i = 0; i < in.face_count; ++i) ++counts[tupleOf(in, f, i)];
  }
  std::vector<std::pair<uint32_t, Tuple>> by_count;
  for (const auto& [tuple, count] : counts) by_count.emplace_back(count, tuple);
  std::stable_sort(by_count.begin(), by_count.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::map<Tuple, int32_t> ranks;
  for (const auto& [count, tuple] : by_count) {
    ranks.emplace(tuple, static_cast<int32_t>(ranks.size()));
    for (uint32_t l = 0; l < in.layer_count; ++l) bytes.push_back(static_cast<uint8_t>(tuple >> (8 * l)));
  }
  return ranks;
}

Result<std::vector<uint8_t>> encodeLabels(const ChunkFrames& in, std::vector<uint8_t>& palette) {
  const std::map<Tuple, int32_t> ranks = buildPalette(in, palette);
  std::vector<std::vector<int32_t>> symbols(in.frame_count, std::vector<int32_t>(in.face_count));
  std::vector<int32_t> previous, current(in.face_count);
  for (uint32_t f = 0; f < in.frame_count; ++f) {
    for (uint32_t i = 0; i < in.face_count; ++i) {
      current[i] = ranks.at(tupleOf(in, f, i));
      symbols[f][i] = kFirstRank + current[i];
      if (i > 0 && current[i] == current[i - 1]) symbols[f][i] = kSameAsPreviousFace;
      if (f > 0 && current[i] == previous[i]) symbols[f][i] = kSameAsPreviousFrame;
    }
    previous = current;
  }
  return encodePointCloud(symbols, in.face_count, 1, draco::PREDICTION_NONE);
}

bool consistent(const ChunkFrames& in) {
  const size_t slots = size_t(in.frame_count) * in.face_count * in.layer_count;
  if (in.frame_count == 0 || in.face_count == 0 || in.layer_count == 0 || in.layer_count > uint32_t(kMaxLayers) ||
      in.positions.size() != size_t(in.frame_count) * in.vertex_count || in.labels.size() != slots) {
    return false;
  }
  for (const glm::ivec3& q : in.positions) {
    if (glm::any(glm::greaterThan(glm::abs(q), glm::ivec3(1 << 24)))) return false;
  }
  return std::all_of(in.labels.begin(), in.labels.end(),
                     [](uint8_t label) { return label < kMaxCameras || label == kNoCamera; });
}

}  // namespace

Result<std::vector<uint8_t>> encodeChunk(const ChunkFrames& frames) {
  if (!consistent(frames)) return Error{ErrorId::Internal, "GOP chunk: counts, positions or labels out of range"};
  std::vector<uint8_t> palette;
  auto positions = encodePositions(frames);
  if (!positions) return positions.error();
  auto labels = encodeLabels(frames, palette);
  if (!labels) return labels.error();
  ByteWriter out;
  out.u32(static_cast<uint32_t>(positions.value().size()));
  out.u32(static_cast<uint32_t>(labels.value().size()));
  out.u32(static_cast<uint32_t>(palette.size() / frames.layer_count));
  out.bytes(palette);
  out.bytes(positions.value());
  out.bytes(labels.value());
  return out.take();
}

}  // namespace fourdvt::package
