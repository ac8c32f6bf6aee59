// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/frame_store.h"

#include <filesystem>

#include "base/hash.h"
#include "base/text.h"
#include "capture/folder/linked_capture.h"
#include "capture/mesh_file.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "store/folder.h"

namespace fourdvt::store {

void fields(Archive& a, reconstruct::FrameFigures& f) {
  a(f.vertices, f.triangles, f.triangles_made, f.footprint_m, f.person_metre_m, f.voxel_m, f.parts_left_out, f.fallback,
    f.volume_m3, f.seen_m3, f.cover, f.overlap, f.outline_px, f.hull_overlap, f.believed, f.moved, f.read_ms,
    f.silhouettes_ms, f.hull_ms, f.stereo_ms, f.fairing_ms, f.check_ms);
}

}  // namespace fourdvt::store

namespace fourdvt::reconstruct {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVersion = "reconstruct 5";  // raise it when the same options give other meshes

}  // namespace

std::string settingsKey(const ReconstructOptions& o, const capture::Capture& capture) {
  const std::string line = printed(
      "%s times %d cameras %d hull %d tolerance %.9g voxel %.9g adaptivity %.9g stereo %d fairing %d planes "
      "%d faces %d%s",
      kVersion, int(o.synchronise), int(o.refine_cameras), int(o.hull), o.contour_tolerance_px, o.voxel_m, o.adaptivity,
      int(o.stereo), o.fairing, o.planes, o.faces, o.mattes_alone ? " mattes alone" : "");
  return capture::inputsKey(capture) + " " + line + "\n";
}

FrameStore::FrameStore(const capture::ResultFolder& folder, const capture::Capture& capture, const std::string& key)
    : folder_(folder), key_(key), metres_per_unit_(capture.metres_per_unit) {
  for (const capture::CaptureSequence& sequence : capture.sequences)
    first_frames_[sequence.name] = sequence.first_frame;
}

Status FrameStore::makeFolders(const std::string& sequence) const {
  FOURDVT_TRY(platform::makeFolder(folder_.partFolder() + "/" + sequence + "/" + capture::kMeshFolder));
  return platform::makeFolder(figuresFolder(sequence));
}

std::string FrameStore::figuresFolder(const std::string& sequence) const {
  return folder_.workFolder() + "/figures_" + hexDigits(fnv1a(key_)) + "/" + sequence;
}

Status FrameStore::checkFolder() const {
  if (folder_.holds(key_)) return {};
  return Error{ErrorId::InvalidArgument, folder_.workFolder() +
                                             ": belongs to a run with other settings now; run the command again, or "
                                             "`fourdvt plan`"};
}

std::string FrameStore::meshPath(const std::string& sequence, uint32_t frame) const {
  return folder_.partFolder() + "/" + sequence + "/" + capture::kMeshFolder + "/" +
         capture::frameName(first_frames_.at(sequence) + frame) + ".ply";
}

std::string FrameStore::figuresPath(const std::string& sequence, uint32_t frame) const {
  return figuresFolder(sequence) + "/" + capture::frameName(frame) + ".bin";
}

std::optional<FrameFigures> FrameStore::find(const std::string& sequence, uint32_t frame) const {
  std::error_code failed;
  if (!fs::exists(meshPath(sequence, frame), failed)) return std::nullopt;
  auto figures = store::load<FrameFigures>(figuresPath(sequence, frame));
  return figures ? std::optional(figures.take()) : std::nullopt;
}

Status FrameStore::save(const std::string& sequence, uint32_t frame, const TriangleMesh& mesh,
                        const FrameFigures& figures) const {
  FOURDVT_TRY(checkFolder());
  TriangleMesh in_units = mesh;
  for (glm::vec3& p : in_units.positions) p /= float(metres_per_unit_);
  FOURDVT_TRY(platform::writeFileAtomic(meshPath(sequence, frame), capture::plyBytes(in_units)));
  return store::save(figuresPath(sequence, frame), figures);
}

void FrameStore::removeLeftovers(const std::string& sequence) const {
  platform::removeEntries(fs::path(meshPath(sequence, 0)).parent_path().string(),
                          [](const std::string& name) { return !name.ends_with(".ply"); });
}

Result<TriangleMesh> FrameStore::loadMesh(const std::string& sequence, uint32_t frame) const {
  FOURDVT_ASSIGN(auto mesh, capture::readMeshFile(meshPath(sequence, frame)));
  for (glm::vec3& p : mesh.positions) p *= float(metres_per_unit_);
  return mesh;
}

}  // namespace fourdvt::reconstruct
