// SPDX-License-Identifier: Apache-2.0
// openCapture: reads the descriptions and checks every file cheaply before long work starts.
#include <algorithm>
#include <filesystem>

#include "capture/capture_json.h"
#include "capture/mesh_sequence.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

Result<DeclaredCapture> readDeclaration(const std::string& folder) {
  const std::string path = folder + "/capture.json";
  const auto text = readText(path);
  if (!text) {
    return Error{ErrorId::FileMissing, path + ": cannot be read; a capture folder needs capture.json, check the path"};
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
  std::string known;
  for (const auto& s : declared.sequences) known += (known.empty() ? "" : ", ") + s.sequence.name;
  std::vector<DeclaredSequence> kept;
  for (const std::string& name : only) {
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

Result<MeshTopology> topologyOf(const DeclaredSequence& declared) {
  const bool packed = !declared.packed_topology.empty();
  FOURDVT_ASSIGN(auto mesh, readObj(packed ? declared.packed_topology : framePath(declared.sequence.mesh_pattern, 0)));
  return std::move(mesh.topology);
}

// Sets capture.topology from the first sequence and checks that all others have the same.
Status checkMeshes(const std::vector<DeclaredSequence>& declared, Capture& capture) {
  for (const DeclaredSequence& d : declared) {
    FOURDVT_ASSIGN(auto topology, topologyOf(d));
    const bool first = &d == &declared.front();
    if (first) capture.topology = std::move(topology);
    if (!first && !sameTopology(topology, capture.topology)) {
      const std::string path = d.packed_topology.empty() ? framePath(d.sequence.mesh_pattern, 0) : d.packed_topology;
      return Error{ErrorId::MeshTopology, path + ": faces or UVs differ from sequence \"" +
                                              declared.front().sequence.name +
                                              "\"; all sequences need one aligned mesh"};
    }
    FOURDVT_TRY(checkMeshSequence(capture, d.sequence));
  }
  return {};
}

// Opening the reader checks that files are there and long enough; reading the first frame checks decoding and sizes.
Status checkPictures(const Capture& capture, const CaptureSequence& sequence, const OpenVideo& open_video) {
  FOURDVT_ASSIGN(auto reader, FrameReader::open(capture, sequence, open_video));
  auto frame = reader->next();
  return frame.ok() ? Status() : Status(frame.error());
}

}  // namespace

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

Result<Capture> openCapture(const std::string& folder, const OpenVideo& open_video,
                            const std::vector<std::string>& only) {
  std::error_code failed;
  const std::string absolute = std::filesystem::absolute(folder, failed).lexically_normal().string();
  FOURDVT_ASSIGN(auto declared, readDeclaration(failed ? folder : absolute));
  FOURDVT_TRY(keepOnly(only, declared));
  Capture capture = std::move(declared.capture);
  FOURDVT_ASSIGN(capture.cameras, readColmapCameras(declared.cameras_folder));
  scaleToMetres(capture.cameras, capture.metres_per_unit);
  for (const DeclaredSequence& d : declared.sequences) capture.sequences.push_back(d.sequence);
  FOURDVT_TRY(checkMeshes(declared.sequences, capture));
  for (const CaptureSequence& sequence : capture.sequences) FOURDVT_TRY(checkPictures(capture, sequence, open_video));
  return capture;
}

}  // namespace fourdvt::capture
