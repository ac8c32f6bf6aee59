// SPDX-License-Identifier: Apache-2.0
// Surfaces of any topology from files as modellers, scanners and reconstructions write them: OBJ, PLY, GLB, glTF.
//
// Vertices keep their number and order; several meshes of a file become one; polygons become triangles (polygon.h); the
// transforms of glTF's nodes are applied. Points, lines, normals, colours and UVs are not read. Does NOT know units.
#pragma once

#include <string>
#include <string_view>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::capture {

// Reads the file at `path`, in the file's units. Memory stays within a small multiple of the file's size. Errors:
// FileMissing, FileUnreadable (damaged, or not what its name says), MeshIndex (no faces, an index out of range),
// MeshNotFinite, Unsupported (a compression or a kind of file that is not read here).
Result<TriangleMesh> readMeshFile(const std::string& path);

// The same for a file's bytes. `path` is for messages, for the kind of file, and for the files that a .gltf names.
Result<TriangleMesh> parseMesh(std::string_view bytes, const std::string& path);

// OBJ with or without UVs.
Result<TriangleMesh> parseObjSurface(std::string_view text, const std::string& path);

// The mesh as a binary little-endian PLY of float positions: what parseMesh, Blender and MeshLab read.
std::string plyBytes(const TriangleMesh& mesh);

}  // namespace fourdvt::capture
