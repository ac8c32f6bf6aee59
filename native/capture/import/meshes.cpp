// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "capture/import/takes.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"

namespace fourdvt::capture {
namespace {

// Returns true for a capture with packed positions in one file, described by its capture.json.
bool holdsPackedPositions(const std::string& folder) {
  const auto entries = sortedEntries(folder);
  return std::any_of(entries.begin(), entries.end(), [](const auto& path) { return path.extension() == ".i16"; });
}

// Finds the meshes of one take. Errors: those of findMeshFiles and checkMeshFiles.
Status findMeshesOf(Take& take, std::vector<std::string>& done, std::vector<std::string>& warnings) {
  const std::string folder = take.folder + "/mesh";
  if (!isFolder(folder)) return {};
  if (!holdsMeshes(folder) && holdsPackedPositions(folder)) {
    done.push_back(folder + ": packed positions, which only their own capture.json describes; they are left out");
    return {};
  }
  if (!holdsMeshes(folder)) {
    warnings.push_back(folder + ": no .obj, .ply, .glb or .gltf in it; export one a frame; it is left out");
    return {};
  }
  CaptureSequence sequence;
  sequence.name = take.name;
  sequence.frame_count = take.frames;
  sequence.first_frame = take.skipped;  // meshes begin with the first instant of all clips
  FOURDVT_TRY(findMeshFiles(folder, sequence));
  FOURDVT_TRY(checkMeshFiles(sequence));
  for (uint32_t frame = 0; frame < take.frames; ++frame) take.meshes.push_back(meshPath(sequence, frame));
  if (!take.hasOneMesh() || take.skipped == take.first_frame) return {};
  return Error{ErrorId::InvalidArgument,
               take.meshes[0] + ": its animation begins " + std::to_string(take.skipped) +
                   " frames before the first instant that all cameras have; cut it to begin " +
                   "there, or export one mesh a frame"};
}

// Topology of an OBJ with UVs.
std::optional<MeshTopology> topologyOf(const std::string& path) {
  if (!path.ends_with(".obj")) return std::nullopt;
  auto mesh = readObj(path);
  return mesh.ok() ? std::optional(std::move(mesh.value().topology)) : std::nullopt;
}

}  // namespace

Result<ImportedMeshes> findMeshes(std::vector<Take>& takes, std::vector<std::string>& done,
                                  std::vector<std::string>& warnings) {
  for (Take& take : takes) FOURDVT_TRY(findMeshesOf(take, done, warnings));
  std::optional<MeshTopology> first;
  bool any = false, constant = true;
  for (const Take& take : takes) {
    if (take.meshes.empty()) continue;
    for (const std::string& path : {take.meshes.front(), take.meshes.back()}) {
      auto topology = topologyOf(path);
      if (!any) first = topology;
      any = true;
      constant = constant && topology && sameTopology(*topology, *first);
    }
  }
  return !any ? ImportedMeshes::None : constant ? ImportedMeshes::ConstantTopology : ImportedMeshes::PerFrame;
}

}  // namespace fourdvt::capture
