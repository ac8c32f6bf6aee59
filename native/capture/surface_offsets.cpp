// SPDX-License-Identifier: Apache-2.0
#include "capture/surface_offsets.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace fourdvt::capture {

std::vector<uint32_t> weldedVertices(const Positions& positions) {
  std::map<std::array<float, 3>, uint32_t> first;
  std::vector<uint32_t> same_as;
  same_as.reserve(positions.size());
  for (const glm::vec3& p : positions)
    same_as.push_back(first.emplace(std::array{p.x, p.y, p.z}, static_cast<uint32_t>(same_as.size())).first->second);
  return same_as;
}

std::vector<glm::uvec3> weldedFaces(const MeshTopology& topology, const std::vector<uint32_t>& same_as) {
  std::vector<glm::uvec3> faces = topology.face_vertices;
  for (glm::uvec3& face : faces)
    for (int k = 0; k < 3; ++k) face[k] = same_as[face[k]];
  return faces;
}

std::vector<float> offsetsAt(const SurfaceOffsets& offsets, const std::string& sequence, uint32_t frame) {
  const auto found = offsets.slow.find(sequence);
  if (found == offsets.slow.end()) return offsets.constant_m;
  const SlowOffsets& slow = found->second;
  const size_t count = slow.frames.size();
  // The listed frames on either side; on a loop the last one precedes the first.
  const size_t after = std::upper_bound(slow.frames.begin(), slow.frames.end(), frame) - slow.frames.begin();
  size_t a = after == 0 ? 0 : after - 1, b = std::min(after, count - 1);
  double share = 0;
  if (slow.loop_frames > 0 && (after == 0 || after == count)) {
    a = count - 1;
    b = 0;
    const uint32_t gap = slow.frames[0] + slow.loop_frames - slow.frames[a];
    const uint32_t past = after == 0 ? frame + slow.loop_frames - slow.frames[a] : frame - slow.frames[a];
    share = double(past) / gap;
  } else if (a != b) {
    share = double(frame - slow.frames[a]) / (slow.frames[b] - slow.frames[a]);
  }
  std::vector<float> out = offsets.constant_m;
  for (size_t v = 0; v < out.size(); ++v)
    out[v] += static_cast<float>((1 - share) * slow.offset_m[a][v] + share * slow.offset_m[b][v]);
  return out;
}

void addOffsets(const SurfaceOffsets& offsets, const MeshTopology& topology, const std::vector<float>& offset_m,
                Positions& positions) {
  assert(offset_m.size() == positions.size() && offsets.same_as.size() == positions.size());
  std::vector<glm::vec3> normals;
  computeVertexNormals(weldedFaces(topology, offsets.same_as), positions.data(), positions.size(), normals);
  for (size_t v = 0; v < positions.size(); ++v) {
    const uint32_t place = offsets.same_as[v];
    positions[v] += offset_m[place] * normals[place];
  }
}

}  // namespace fourdvt::capture
