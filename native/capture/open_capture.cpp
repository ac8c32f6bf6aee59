// SPDX-License-Identifier: Apache-2.0
// openDescription: reads the descriptions and checks every mesh file cheaply before long work starts.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/text.h"
#include "capture/capture_json.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

Result<DeclaredCapture> readDeclaration(const std::string& folder) {
  const std::string path = folder + "/capture.json";
  const auto text = readText(path);
  if (!text) {
    return Error{ErrorId::FileMissing,
                 path +
                     ": cannot be read; check the path, or write one, at least {\"fps\": 25, \"sequences\": "
                     "[{\"name\": \"walk\", \"frames\": 120}]}"};
  }
  return parseCaptureJson(*text, folder);
}

void dropIncompleteClasses(DeclaredCapture& declared) {
  const auto kept = [&](const CaptureClass::MemberOf& member) {
    return std::any_of(declared.sequences.begin(), declared.sequences.end(),
                       [&](const DeclaredSequence& s) { return s.sequence.name == member.sequence; });
  };
  std::erase_if(declared.capture.classes,
                [&](const CaptureClass& c) { return !std::all_of(c.members.begin(), c.members.end(), kept); });
}

Status keepOnly(const std::vector<std::string>& only, DeclaredCapture& declared) {
  if (only.empty()) return {};
  const std::string known = joined(declared.sequences, ", ", [](const auto& s) { return s.sequence.name; });
  std::vector<DeclaredSequence> kept;
  for (const std::string& name : only) {
    if (std::any_of(kept.begin(), kept.end(), [&](const auto& s) { return s.sequence.name == name; })) continue;
    const auto it = std::find_if(declared.sequences.begin(), declared.sequences.end(),
                                 [&](const DeclaredSequence& s) { return s.sequence.name == name; });
    if (it == declared.sequences.end()) {
      return Error{ErrorId::InvalidArgument,
                   declared.capture.folder + "/capture.json: no sequence \"" + name + "\"; choose among: " + known};
    }
    kept.push_back(*it);
  }
  declared.sequences = std::move(kept);
  dropIncompleteClasses(declared);
  return {};
}

// Determines the kind of a sequence's meshes, and completes its mesh_pattern where used.
Result<CaptureMeshes> resolveMeshes(bool per_frame, MeshNeed need, DeclaredSequence& declared) {
  if (declared.without_meshes) return CaptureMeshes::None;
  CaptureSequence& sequence = declared.sequence;
  const std::string folder = sequence.folder + "/mesh";
  if (per_frame && need == MeshNeed::ConstantTopology) return CaptureMeshes::PerFrame;
  const CaptureMeshes meshes = per_frame ? CaptureMeshes::PerFrame : CaptureMeshes::ConstantTopology;
  if (!declared.packed_topology.empty()) return meshes;
  if (!sequence.mesh_pattern.empty()) {
    findFirstMesh(sequence);
    return meshes;
  }
  if (!per_frame && !isFolder(folder)) return CaptureMeshes::None;
  FOURDVT_TRY(findMeshFiles(folder, sequence));
  return meshes;
}

Status refuse(const std::string& folder, CaptureMeshes meshes, MeshNeed need) {
  const std::string path = folder + "/capture.json: ";
  if (meshes == CaptureMeshes::None && need != MeshNeed::Nothing)
    return Error{ErrorId::FileMissing, path + "the capture has no meshes; " + kRunReconstruct};
  if (meshes == CaptureMeshes::PerFrame && need == MeshNeed::ConstantTopology) {
    return Error{ErrorId::MeshTopology,
                 path + "the meshes are of \"per-frame\" topology, but layers need meshes of constant topology with " +
                     "UVs; fit one mesh with UVs to all frames first, or bake with --appearance cameras"};
  }
  return {};
}

// Sets capture.meshes, and the files of the sequences' meshes.
Status resolveAllMeshes(MeshNeed need, DeclaredCapture& declared) {
  Capture& capture = declared.capture;
  capture.meshes = CaptureMeshes::None;
  for (DeclaredSequence& d : declared.sequences) {
    CaptureMeshes meshes = CaptureMeshes::None;
    if (need == MeshNeed::Nothing) {
      d.sequence.mesh_pattern = d.sequence.packed_positions = {};
    } else {
      FOURDVT_ASSIGN(meshes, resolveMeshes(declared.per_frame, need, d));
    }
    if (&d == &declared.sequences.front()) capture.meshes = meshes;
    if (meshes == capture.meshes) continue;
    const std::string& without = meshes == CaptureMeshes::None ? d.sequence.name : declared.sequences[0].sequence.name;
    return Error{ErrorId::FileMissing, capture.folder + "/" + without + "/mesh: sequence \"" + without +
                                           "\" has no meshes, but others have; add them, or choose other sequences"};
  }
  return refuse(capture.folder, capture.meshes, need);
}

// Sets capture.topology from the first sequence and checks that all others have the same.
Status checkTopology(const std::vector<DeclaredSequence>& declared, Capture& capture) {
  std::optional<EdgeLengths> reference;
  for (const DeclaredSequence& d : declared) {
    const bool packed = !d.packed_topology.empty();
    FOURDVT_ASSIGN(auto mesh,
                   packed ? readObj(d.packed_topology, &capture.topology) : readUvMesh(capture, d.sequence, 0));
    const bool first = &d == &declared.front();
    if (first) capture.topology = std::move(mesh.topology);
    if (!first && !sameTopology(mesh.topology, capture.topology)) {
      return Error{ErrorId::MeshTopology,
                   (packed ? d.packed_topology : meshPath(d.sequence, 0)) + ": faces or UVs differ from sequence \"" +
                       declared.front().sequence.name + "\"; all sequences need one aligned mesh"};
    }
    FOURDVT_TRY(checkMeshSequence(capture, d.sequence, reference));
  }
  return {};
}

// Checks for meshes of per-frame topology that the files exist and that a single file of all frames is long enough:
// reading the first frame parses the file.
Status checkMeshes(const std::vector<DeclaredSequence>& declared, Capture& capture) {
  if (capture.meshes == CaptureMeshes::ConstantTopology) return checkTopology(declared, capture);
  if (capture.meshes == CaptureMeshes::PerFrame) {
    for (const DeclaredSequence& d : declared) {
      FOURDVT_TRY(checkMeshFiles(d.sequence));
      if (!meshInstant(capture, d.sequence, 0).whole_take) continue;
      const auto last = readSurfaceFrame(capture, d.sequence, d.sequence.frame_count - 1);
      if (!last.ok()) return last.error();
    }
  }
  return {};
}

Status applySkew(const std::map<std::string, double>& skew, Capture& capture) {
  for (const auto& entry : skew) {
    const std::string& name = entry.first;
    const auto it = std::find_if(capture.cameras.begin(), capture.cameras.end(),
                                 [&](const CaptureCamera& camera) { return camera.pinhole.name == name; });
    if (it == capture.cameras.end()) {
      return Error{ErrorId::CaptureJson, capture.folder + "/capture.json: \"skew\" names the camera \"" + name +
                                             "\", which " + capture.cameras_folder + " has not; take it out"};
    }
    it->distortion.skew = entry.second;
  }
  return {};
}

// Checks that offsets name cameras, are shorter than the clip, and leave a picture for frame 0.
Status checkOffsets(const Capture& capture, const CaptureSequence& sequence) {
  const std::string where = capture.folder + "/capture.json: \"offset_frames\" of \"" + sequence.name + "\"";
  int64_t lacking = 0;  // missing pictures before the first one
  std::string of_first;
  for (const auto& entry : sequence.offset_frames) {
    const std::string& name = entry.first;
    const double frames = entry.second;
    const auto known = std::any_of(capture.cameras.begin(), capture.cameras.end(),
                                   [&](const CaptureCamera& c) { return c.pinhole.name == name; });
    const std::string text = printed("%g", frames);
    if (!known) {
      return Error{ErrorId::CaptureJson, where + " names the camera \"" + name + "\", which " + capture.cameras_folder +
                                             " has not; take it out"};
    }
    const std::string of_camera = where + ", " + text + " of camera \"" + name + "\", ";
    if (!(std::abs(frames) < sequence.first_frame + sequence.frame_count)) {
      return Error{ErrorId::CaptureJson, of_camera + "is longer than the clip of " +
                                             std::to_string(sequence.frame_count) +
                                             " frames; correct it, or leave the camera out"};
    }
    const int64_t here = -(int64_t(sequence.first_frame) + std::llround(frames));
    if ((!sequence.loop || sequence.travel) && here > lacking) lacking = here, of_first = of_camera;
  }
  if (lacking == 0) return {};
  return Error{ErrorId::CaptureJson, of_first + "leaves no picture for frame 0; set \"first_frame\" to " +
                                         std::to_string(sequence.first_frame + lacking) +
                                         " at least, and take as much off \"frames\""};
}

}  // namespace

double CaptureSequence::offsetOf(const std::string& camera) const {
  const auto at = offset_frames.find(camera);
  return at == offset_frames.end() ? 0 : at->second;
}

uint32_t CaptureSequence::pictureOf(const std::string& camera, uint32_t frame) const {
  const int64_t count = frame_count;
  int64_t at = int64_t(frame) + std::llround(offsetOf(camera));
  if (loop && !travel && count > 0) at = (at % count + count) % count;
  return uint32_t(std::max<int64_t>(0, first_frame + at));
}

const CaptureSequence* Capture::find(const std::string& wanted) const {
  for (const CaptureSequence& sequence : sequences) {
    if (sequence.name == wanted) return &sequence;
  }
  return nullptr;
}

Result<std::vector<PinholeCamera>> readTestCameras(const Capture& capture) {
  FOURDVT_ASSIGN(auto cameras, readColmapCameras(capture.folder + "/cameras_test"));
  scaleToMetres(cameras, capture.metres_per_unit);
  std::vector<PinholeCamera> out;
  for (const CaptureCamera& camera : cameras) out.push_back(camera.pinhole);
  return out;
}

Result<Capture> openDescription(const std::string& folder, const std::vector<std::string>& only, MeshNeed need) {
  std::error_code failed;
  std::filesystem::path path = std::filesystem::absolute(folder, failed).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // trailing slash
  const std::string absolute = path.string();
  FOURDVT_ASSIGN(auto declared, readDeclaration(failed ? folder : absolute));
  FOURDVT_TRY(keepOnly(only, declared));
  FOURDVT_TRY(resolveAllMeshes(need, declared));
  Capture capture = std::move(declared.capture);
  FOURDVT_ASSIGN(capture.cameras, readColmapCameras(capture.cameras_folder));
  scaleToMetres(capture.cameras, capture.metres_per_unit);
  FOURDVT_TRY(applySkew(declared.skew, capture));
  for (CaptureCamera& camera : capture.cameras) camera.orientation = declared.orientation;
  for (const DeclaredSequence& d : declared.sequences) capture.sequences.push_back(d.sequence);
  for (const CaptureSequence& sequence : capture.sequences) FOURDVT_TRY(checkOffsets(capture, sequence));
  FOURDVT_TRY(checkMeshes(declared.sequences, capture));
  return capture;
}

}  // namespace fourdvt::capture
