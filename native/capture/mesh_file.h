// SPDX-License-Identifier: Apache-2.0
// Surfaces of any topology from files as modellers, scanners and reconstructions write them: OBJ, PLY, GLB, glTF.
//
// Vertices keep their number and order; several meshes of a file become one; polygons become triangles (polygon.h);
// glTF's nodes, skins, morph targets and animation are applied. Points, lines, normals and colours are skipped.
// Positions stay in the file's units.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// Instant at which an animated file (glTF) is read: time since the animation's first key.
struct MeshInstant {
  std::string take = {};  // name of the animation to read where a file has several
  double time_s = 0;
  double frame_s = 0;       // frame interval; 0: unknown, and lengths are not checked
  bool whole_take = false;  // the file has the meshes of all frames; false: of one, and a longer animation is an error
};

// Reads the file at `path`, in the file's units. Memory stays within a small multiple of the file's size. Errors:
// FileMissing, FileUnreadable (damaged, or contents that contradict the name), MeshIndex (no faces, an index out of
// range), MeshNotFinite, Unsupported (an unsupported compression or kind of file, an animation that exceeds one frame),
// VideoTooShort (the animation ends before the instant).
Result<TriangleMesh> readMeshFile(const std::string& path, const MeshInstant& instant = {});

// Parses a file's bytes. `path`: for messages, for the kind of file, and for the files that a .gltf names.
Result<TriangleMesh> parseMesh(std::string_view bytes, const std::string& path, const MeshInstant& instant = {});

// Reads a glTF file with UVs; vertices split only by seams of UVs or normals are merged, so that the faces are those of
// a mesh of constant topology. Errors: those of readMeshFile, MeshNoUvs, MeshUvRange.
Result<UvMesh> readUvGltf(const std::string& path, const MeshInstant& instant);
Result<UvMesh> parseUvGltf(std::string_view bytes, const std::string& path, const MeshInstant& instant);

// True for names that end in .obj, .ply, .glb or .gltf; or in .glb or .gltf.
bool isMeshName(const std::string& name);
bool isGltfName(const std::string& name);
// Kind of file by its name if it holds meshes of an unsupported kind ("Alembic"), else empty.
std::string otherMeshKind(const std::string& name);
inline constexpr const char* kExportReadable =
    "export one OBJ, PLY or glTF file a frame, or one animated .glb of the take";

// Parses an OBJ with or without UVs.
Result<TriangleMesh> parseObjSurface(std::string_view text, const std::string& path);

// Binary little-endian PLY of float positions, for parseMesh, Blender and MeshLab.
std::string plyBytes(const TriangleMesh& mesh);

// OBJ with UVs, for parseObj: positions times `scale`, to a tenth of a millimetre or less, UVs with the origin at the
// bottom left, faces as "v/vt" counted from 1.
std::string objText(const MeshTopology& topology, const Positions& positions, double scale);

// Appends a frame of packed positions: little-endian int16 [vertex][xyz], metres times `units_per_metre`, to the
// nearest unit. Requires them to fit: at most 32767 units in size.
void appendPacked(const Positions& positions, double units_per_metre, std::vector<uint8_t>& out);

}  // namespace fourdvt::capture
