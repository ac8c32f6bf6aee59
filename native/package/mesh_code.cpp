// SPDX-License-Identifier: Apache-2.0
#include "package/mesh_code.h"

#include "base/bytes.h"
#include "package/mesh_model.h"

namespace fourdvt::package {
namespace {

constexpr uint64_t kMaxFacesPerByte = 64;

Error invalidMesh(const char* what) {
  return {ErrorId::MeshDataInvalid, std::string("base mesh: ") + what + "; the start file is damaged, upload it again"};
}

// Decoder's stand-in for the mesh; the coder ignores its results.
struct UnknownMesh {
  const BinaryDecoder& coder;
  bool lost() const { return coder.overrun(); }
  bool attaches(const MeshLinks&, const std::vector<uint32_t>&, uint32_t) { return false; }
  uint32_t cornerAt(uint32_t, uint32_t) const { return 0; }
  bool newVertex(uint32_t) const { return false; }
  void addVertex(uint32_t, uint32_t) {}
  uint32_t vertex(uint32_t) const { return 0; }
  bool opposite(uint32_t, uint32_t) const { return false; }
  template <class... Args>
  uint32_t wayTo(const Args&...) const {
    return 0;
  }
  bool newUv(uint32_t) const { return false; }
  void addUv(uint32_t, uint32_t) {}
  uint32_t uv(uint32_t) const { return 0; }
  template <class... Args>
  std::vector<uint32_t> places(const Args&...) const {
    return {};
  }
};

MeshGrid readGrid(ByteReader& in, int components) {
  MeshGrid grid;
  for (int k = 0; k < components; ++k) grid.min[k] = in.f32();
  grid.step = in.f32();
  return grid;
}

}  // namespace

Result<BaseMesh> decodeMeshCode(std::span<const uint8_t> bytes, uint32_t max_vertices, uint32_t max_faces) {
  ByteReader in(bytes);
  MeshHeader h;
  h.vertex_count = in.u32(), h.uv_count = in.u32(), h.face_count = in.u32();
  h.positions = readGrid(in, 3);
  h.uvs = readGrid(in, 2);
  max_faces = static_cast<uint32_t>(std::min<uint64_t>({max_faces, kMaxFaces, kMaxFacesPerByte * bytes.size()}));
  if (!in.ok() || h.face_count < 1 || h.face_count > max_faces || h.vertex_count < 3 || h.vertex_count > max_vertices ||
      h.vertex_count > 3 * h.face_count || h.uv_count < 1 || h.uv_count > 3 * h.face_count)
    return invalidMesh("bad counts");
  BinaryDecoder coder(in.bytes(in.remaining()));
  UnknownMesh unknown{coder};
  MeshContents out(h);
  if (!MeshModel(coder, unknown, h, out).code() || !coder.finished()) return invalidMesh("it does not decode");
  return std::move(out.mesh);
}

}  // namespace fourdvt::package
