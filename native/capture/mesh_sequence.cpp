// SPDX-License-Identifier: Apache-2.0
#include "capture/mesh_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/hash.h"
#include "capture/mesh_file.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

// Lines of an OBJ text that are equal in all frames of one topology, and its positions.
struct ObjOutline {
  size_t faces = 0;
  uint64_t connectivity = kFnv1aStart;  // hash of the vt and f lines
  bool plain = true;                    // v lines begin with finite numbers, and no line is continued
  Positions positions;
  bool hasFacesOf(const ObjOutline& other) const {
    return plain && faces == other.faces && connectivity == other.connectivity &&
           positions.size() == other.positions.size();
  }
};

ObjOutline outlineOf(std::string_view text) {
  ObjOutline outline;
  std::string_view line;
  while (takeLine(text, line)) {
    outline.plain &= !line.ends_with('\\');
    if (line.starts_with("v ")) {
      line.remove_prefix(2);
      glm::vec3& p = outline.positions.emplace_back();
      for (int k = 0; k < 3; ++k) p[k] = toNumber<float>(takeWord(line)).value_or(NAN);
      outline.plain &= std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    } else if (line.starts_with("f ") || line.starts_with("vt ")) {
      outline.faces += line.front() == 'f';
      outline.connectivity = fnv1a("\n", fnv1a(line, outline.connectivity));
    }
  }
  return outline;
}

Error missing(const std::string& path) {
  return {ErrorId::FileMissing,
          path + ": mesh file cannot be read; check \"mesh\", \"topology\" and \"frames\" in capture.json"};
}

Error otherTopology(const std::string& path, const std::string& what) {
  return {ErrorId::MeshTopology, path + ": " + what + "; every frame needs the same faces and UVs (one aligned mesh)"};
}

Error otherMesh(const std::string& path, const CaptureSequence& sequence, uint32_t frame, const std::string& what) {
  return {
      ErrorId::MeshTopology,
      path + ": frame " + std::to_string(frame) + " of \"" + sequence.name + "\" " + what +
          "; export all frames from one mesh, with its vertex order kept, or write \"topology\": \"per-frame\" into "
          "capture.json and bake with --appearance cameras"};
}

Status checkPacked(const Capture& capture, const CaptureSequence& sequence) {
  std::error_code failed;
  const uint64_t size = std::filesystem::file_size(sequence.packed_positions, failed);
  if (failed) return missing(sequence.packed_positions);
  const uint64_t frames = uint64_t{sequence.first_frame} + sequence.frame_count;
  const bool cut = sequence.first_frame > 0 || !sequence.offset_frames.empty();  // only a part of the clip is used
  const uint64_t expected = frames * capture.topology.vertex_count * 6;
  if (size == expected || (cut && size > expected)) return {};
  return otherTopology(sequence.packed_positions, "holds " + std::to_string(size) + " bytes instead of " +
                                                      std::to_string(expected) + " (frames x vertices x 6)");
}

Result<Positions> readPacked(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  const size_t count = size_t{capture.topology.vertex_count} * 3;
  std::ifstream file(sequence.packed_positions, std::ios::binary);
  if (!file) return missing(sequence.packed_positions);
  std::vector<int16_t> values(count);  // all supported targets are little-endian
  file.seekg(static_cast<std::streamoff>(count * 2 * (sequence.first_frame + frame)));
  if (!file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * 2))) {
    return otherTopology(sequence.packed_positions, "ends before frame " + std::to_string(frame));
  }
  Positions positions(count / 3);
  for (size_t i = 0; i < count; ++i) {
    positions[i / 3][static_cast<int>(i % 3)] = static_cast<float>(values[i] / sequence.packed_units_per_metre);
  }
  return positions;
}

void scaleBy(double factor, Positions& positions) {
  for (glm::vec3& p : positions) p *= static_cast<float>(factor);
}

Result<Positions> readGivenFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  FOURDVT_TRY(checkFrame(sequence, frame));
  if (!sequence.packed_positions.empty()) return readPacked(capture, sequence, frame);
  FOURDVT_ASSIGN(auto mesh, readUvMesh(capture, sequence, frame));
  const MeshTopology &own = mesh.topology, &first = capture.topology;
  if (own.vertex_count != first.vertex_count || own.faceCount() != first.faceCount()) {
    return otherMesh(meshPath(sequence, frame), sequence, frame,
                     "has " + std::to_string(own.vertex_count) + " vertices and " + std::to_string(own.faceCount()) +
                         " triangles, not " + std::to_string(first.vertex_count) + " and " +
                         std::to_string(first.faceCount()) + " as the first one");
  }
  if (!sameTopology(own, first))
    return otherMesh(meshPath(sequence, frame), sequence, frame,
                     "has other faces or UVs than the first one, or in another order");
  Positions positions = std::move(mesh.positions);
  scaleBy(capture.metres_per_unit, positions);
  return positions;
}

constexpr float kGrowth = 5, kSpan = 0.05f, kShortest = 1e-6f;  // ratio; shares of the mesh's size: span, and edge
                                                                // length below which a degenerate edge may open

// Diagonal of the bounding box.
float sizeOf(const Positions& positions) {
  const BoundingBox box = boundsOf(positions);
  return glm::distance(box.min, box.max);
}

}  // namespace

Status checkFrame(const CaptureSequence& sequence, uint32_t frame) {
  if (frame < sequence.frame_count) return {};
  return Error{ErrorId::InvalidArgument, sequence.name + " has no frame " + std::to_string(frame) + "; it has " +
                                             std::to_string(sequence.frame_count)};
}

std::string framePath(const std::string& pattern, uint32_t frame) {
  const size_t begin = pattern.find('%');
  if (begin == std::string::npos || pattern.find('%', begin + 1) != std::string::npos) return {};
  size_t end = begin + 1, width = 0;
  while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9' && width < 20) {
    width = width * 10 + static_cast<size_t>(pattern[end++] - '0');
  }
  if (end >= pattern.size() || pattern[end] != 'd' || width > 19) return {};
  std::string digits = std::to_string(frame);
  if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
  return pattern.substr(0, begin) + digits + pattern.substr(end + 1);
}

std::string meshPath(const CaptureSequence& sequence, uint32_t frame) {
  const std::string numbered = framePath(sequence.mesh_pattern, sequence.first_mesh + sequence.first_frame + frame);
  return numbered.empty() ? sequence.mesh_pattern : numbered;
}

Result<UvMesh> readObj(const std::string& path, const MeshTopology* split_as) {
  const auto text = readText(path);
  if (!text) return missing(path);
  return parseObj(*text, path, split_as);
}

bool sameTopology(const MeshTopology& a, const MeshTopology& b) {
  return a.vertex_count == b.vertex_count && a.face_vertices == b.face_vertices && a.face_uvs == b.face_uvs &&
         a.uvs == b.uvs;
}

MeshInstant meshInstant(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  const bool whole_take = sequence.frame_count > 1 && framePath(sequence.mesh_pattern, 0).empty();
  const double picture = whole_take ? double(sequence.first_frame) + frame : 0;
  return {sequence.name, picture / capture.fps, 1 / capture.fps, whole_take};
}

Result<UvMesh> readUvMesh(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  const std::string path = meshPath(sequence, frame), other = otherMeshKind(path);
  if (isGltfName(path)) return readUvGltf(path, meshInstant(capture, sequence, frame));
  if (path.ends_with(".ply") || path.ends_with(".PLY")) {
    return Error{ErrorId::Unsupported, path + ": UVs of PLY are not read; write \"topology\": \"per-frame\" into " +
                                           "capture.json for meshes that differ, or export one mesh that moves as OBJ"};
  }
  if (!other.empty()) return Error{ErrorId::Unsupported, path + ": " + other + " is not read; " + kExportReadable};
  return readObj(path, &capture.topology);
}

Status checkMeshSequence(const Capture& capture, const CaptureSequence& sequence,
                         std::optional<EdgeLengths>& reference) {
  if (!sequence.packed_positions.empty()) return checkPacked(capture, sequence);
  const bool obj = !isGltfName(sequence.mesh_pattern);
  ObjOutline first;
  for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
    const bool whole_take = meshInstant(capture, sequence, frame).whole_take;
    if (whole_take && frame > 0) frame = sequence.frame_count - 1;
    const std::string path = meshPath(sequence, frame);
    ObjOutline outline;
    if (obj) {
      const auto text = readText(path);
      if (!text) return missing(path);
      outline = outlineOf(*text);
    }
    if (!obj || frame == 0 || !outline.hasFacesOf(first)) {
      FOURDVT_ASSIGN(outline.positions, readMeshFrame(capture, sequence, frame));
    }
    if (!reference) reference.emplace(capture.topology.face_vertices, outline.positions);
    const double grown = reference->grown(outline.positions);
    if (grown > kMaxGrown && !whole_take) {
      return otherMesh(path, sequence, frame,
                       "has its vertices in another order than the first one (" +
                           std::to_string(std::lround(100 * grown)) + " % of its edges are over five times as long)");
    }
    if (frame == 0) first = std::move(outline);
  }
  return {};
}

Result<Positions> readMeshFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  if (capture.meshes != CaptureMeshes::ConstantTopology) {
    return Error{ErrorId::MeshTopology,
                 capture.folder + ": its meshes have no constant topology; this needs one mesh for all frames"};
  }
  FOURDVT_ASSIGN(auto positions, readGivenFrame(capture, sequence, frame));
  if (capture.offsets)
    addOffsets(*capture.offsets, capture.topology, offsetsAt(*capture.offsets, sequence.name, frame), positions);
  return positions;
}

Result<Positions> readMeshFrameInPlace(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  FOURDVT_ASSIGN(auto positions, readMeshFrame(capture, sequence, frame));
  putInPlace(sequence, frame, positions);
  return positions;
}

void putInPlace(const CaptureSequence& sequence, uint32_t frame, Positions& positions) {
  if (!sequence.travel) return;
  const auto& [motion, place_m] = *sequence.travel;
  const GroundMotion back = shareOf(motion, 0.5 - double(frame) / sequence.frame_count);
  for (glm::vec3& p : positions) p = glm::vec3(back(p) - glm::dvec3(place_m.x, 0, place_m.y));
}

Result<TriangleMesh> readSurfaceFrame(const Capture& capture, const CaptureSequence& sequence, uint32_t frame) {
  FOURDVT_TRY(checkFrame(sequence, frame));
  switch (capture.meshes) {
    case CaptureMeshes::ConstantTopology: {
      FOURDVT_ASSIGN(auto positions, readMeshFrame(capture, sequence, frame));
      return TriangleMesh{std::move(positions), capture.topology.face_vertices};
    }
    case CaptureMeshes::PerFrame: {
      FOURDVT_ASSIGN(auto mesh, readMeshFile(meshPath(sequence, frame), meshInstant(capture, sequence, frame)));
      scaleBy(capture.metres_per_unit, mesh.positions);
      return mesh;
    }
    case CaptureMeshes::None:
      break;
  }
  return Error{ErrorId::FileMissing, capture.folder + ": the capture has no meshes; " + kRunReconstruct};
}

EdgeLengths::EdgeLengths(const std::vector<glm::uvec3>& faces, const Positions& positions) {
  const float size = sizeOf(positions);
  if (!(size > 0)) return;
  for (const glm::uvec3& face : faces) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = face[k], b = face[(k + 1) % 3];
      const float length = glm::distance(positions[a], positions[b]) / size;
      if (length > kShortest) edges_.push_back({a, b, length});
    }
  }
}

double EdgeLengths::grown(const Positions& positions) const {
  const float size = sizeOf(positions);
  if (edges_.empty() || !(size > 0)) return 0;
  const auto grown = std::count_if(edges_.begin(), edges_.end(), [&](const Edge& edge) {
    const float length = glm::distance(positions[edge.a], positions[edge.b]) / size;
    return length > kSpan && length > kGrowth * edge.length;
  });
  return static_cast<double>(grown) / static_cast<double>(edges_.size());
}

}  // namespace fourdvt::capture
