// SPDX-License-Identifier: Apache-2.0
// Mesh files of a sequence: searches for them by the numbers in their names (mesh_folder.cpp), and checks that all have
// one topology. Frames are not kept in memory.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/mesh.h"
#include "capture/capture.h"
#include "capture/mesh_file.h"

namespace fourdvt::capture {

// Remedy for missing meshes where they are required.
inline constexpr const char* kRunReconstruct = "run `fourdvt reconstruct CAPTURE -o CAPTURE2` first, and use CAPTURE2";

// Error InvalidArgument if the sequence has no such frame.
Status checkFrame(const CaptureSequence& sequence, uint32_t frame);

// Path of one frame, from a pattern with exactly one %d or %0Nd; empty for other patterns.
std::string framePath(const std::string& pattern, uint32_t frame);

// Path of a frame's mesh file; the sequence is not packed.
std::string meshPath(const CaptureSequence& sequence, uint32_t frame);

// Instant of a frame in its mesh file. A single file of several frames begins with picture 0, not with frame 0.
MeshInstant meshInstant(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

// Reads the whole OBJ at `path`. `split_as` and errors: as in parseObj, and FileMissing.
Result<UvMesh> readObj(const std::string& path, const MeshTopology* split_as = nullptr);

// Reads a frame's mesh with its UVs, in the file's units; polygons are split as in the capture's topology. Errors:
// those of readObj and readUvGltf; Unsupported (files of another kind).
Result<UvMesh> readUvMesh(const Capture& capture, const CaptureSequence& sequence, uint32_t frame);

bool sameTopology(const MeshTopology& a, const MeshTopology& b);

// Detects, by edge lengths, frames of a mesh whose vertices are permuted while its faces stay.
class EdgeLengths {
 public:
  // Measures the faces' edges at one instant.
  EdgeLengths(const std::vector<glm::uvec3>& faces, const Positions& positions);
  // Share of edges that, relative to the mesh's size, are over five times as long at another instant and span a
  // twentieth of it: about 0 for a moving surface, about 1 for shuffled vertices.
  double grown(const Positions& positions) const;

 private:
  struct Edge {
    uint32_t a, b;
    float length;  // relative to the mesh's size
  };
  std::vector<Edge> edges_;
};

inline constexpr double kMaxGrown = 0.05;  // maximum share for a moving surface

// Checks that every mesh frame exists and has the capture's topology, with vertices in the order of `reference`, which
// is made from the first frame if empty. Reads all files, but parses faces only where the topology lines differ from
// the first file's. Errors: FileMissing, MeshTopology and those of readUvMesh.
Status checkMeshSequence(const Capture& capture, const CaptureSequence& sequence,
                         std::optional<EdgeLengths>& reference);

// True if the folder contains a mesh: .obj, .ply, .glb or .gltf.
bool holdsMeshes(const std::string& folder);

// Sets the sequence's mesh_pattern and first_mesh from the files of `folder` that end in .obj, .ply, .glb or .gltf:
// numbered files with any prefix and suffix, or the only file, for a sequence of one frame or for glTF. Errors:
// FileMissing (no such folder, no meshes in it), InvalidArgument (several candidates, one static mesh for several
// frames), Unsupported (meshes of unsupported kinds only).
Status findMeshFiles(const std::string& folder, CaptureSequence& sequence);

// Sets first_mesh for the sequence's mesh_pattern: 0 if the numbers are the frames', else the first existing number.
void findFirstMesh(CaptureSequence& sequence);

// Error FileMissing with the first frame without a file and the count of missing files.
Status checkMeshFiles(const CaptureSequence& sequence);

}  // namespace fourdvt::capture
