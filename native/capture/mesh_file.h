// SPDX-License-Identifier: Apache-2.0
// Surfaces of any topology from files as modellers, scanners and reconstructions write them: OBJ, PLY, GLB, glTF.
//
// Vertices keep their number and order; several meshes of a file become one; polygons become triangles (polygon.h);
// glTF's nodes, skins, morph targets and animation are applied. Points, lines, normals and colours are not read. Does
// NOT know units.
#pragma once

#include <string>
#include <string_view>

#include "base/mesh.h"
#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// The instant at which a mesh is read, in files that are animated (glTF): so long after the animation's first key.
struct MeshInstant {
  std::string take = {};  // name of the animation that is read where a file has several
  double time_s = 0;
  double frame_s = 0;  // between frames; 0: unknown, and lengths are not checked
  bool whole_take =
      false;  // the file is the mesh of all frames; else of one, and its animation may not go on for longer
};

// Reads the file at `path`, in the file's units. Memory stays within a small multiple of the file's size. Errors:
// FileMissing, FileUnreadable (damaged, or not what its name says), MeshIndex (no faces, an index out of range),
// MeshNotFinite, Unsupported (a compression or a kind of file that is not read here, an animation that does not belong
// to one frame), VideoTooShort (the animation ends before the instant).
Result<TriangleMesh> readMeshFile(const std::string& path, const MeshInstant& instant = {});

// The same for a file's bytes. `path` is for messages, for the kind of file, and for the files that a .gltf names.
Result<TriangleMesh> parseMesh(std::string_view bytes, const std::string& path, const MeshInstant& instant = {});

// The same of a glTF file with UVs: vertices that only seams of UVs or normals part are one, so that the faces are
// those of a mesh of constant topology. Errors: also MeshNoUvs, MeshUvRange.
Result<UvMesh> readUvGltf(const std::string& path, const MeshInstant& instant);
Result<UvMesh> parseUvGltf(std::string_view bytes, const std::string& path, const MeshInstant& instant);

// True for names that end in .obj, .ply, .glb or .gltf; or in one of the latter two.
bool isMeshName(const std::string& name);
bool isGltfName(const std::string& name);
// The name's kind of file if it holds meshes that are not read here ("Alembic"), else empty.
std::string otherMeshKind(const std::string& name);
inline constexpr const char* kExportReadable =
    "export one OBJ, PLY or glTF file a frame, or one animated .glb of the take";

// OBJ with or without UVs.
Result<TriangleMesh> parseObjSurface(std::string_view text, const std::string& path);

// The mesh as a binary little-endian PLY of float positions: what parseMesh, Blender and MeshLab read.
std::string plyBytes(const TriangleMesh& mesh);

}  // namespace fourdvt::capture
