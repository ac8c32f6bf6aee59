// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/frame_store.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "base/hash.h"
#include "capture/mesh_file.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "reconstruct/run/linked_capture.h"
#include "reconstruct/run/report.h"

namespace fourdvt::reconstruct {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVersion = "reconstruct 2";  // raise it when the same options give other meshes

std::string frameName(uint32_t frame) {
  char text[16];
  std::snprintf(text, sizeof text, "%06u", frame);
  return text;
}

// Names relative to `folder`, sizes and times of all files below it, except meshes and held-out pictures.
std::vector<std::string> filesOf(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failed, ignored;
  constexpr auto kFollow = fs::directory_options::follow_directory_symlink;
  for (fs::recursive_directory_iterator it(folder, kFollow, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string name = it->path().filename().string();
    if (it.depth() == 0 && (name == kMeshFolder || name.starts_with("test"))) {
      it.disable_recursion_pending();
      continue;
    }
    if (!it->is_regular_file(ignored)) continue;
    files.push_back(it->path().lexically_relative(folder).string() + " " + std::to_string(it->file_size(ignored)) +
                    " " + std::to_string(it->last_write_time(ignored).time_since_epoch().count()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Whether `inner` is `outer` or lies below it; both without links.
bool within(const fs::path& inner, const fs::path& outer) {
  const auto [a, b] = std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end());
  return a == outer.end();
}

}  // namespace

std::string settingsKey(const ReconstructOptions& o, const capture::Capture& capture) {
  char line[200];
  std::snprintf(line, sizeof line,
                "%s hull %d tolerance %.9g voxel %.9g adaptivity %.9g stereo %d fairing %d planes %d faces %d",
                kVersion, int(o.hull), o.contour_tolerance_px, o.voxel_m, o.adaptivity, int(o.stereo), o.fairing,
                o.planes, o.faces);
  uint64_t hash = kFnv1aStart;
  const auto add = [&](const std::string& text) {
    hash = fnv1a(std::string_view(text.c_str(), text.size() + 1), hash);
  };
  const capture::ColmapText cameras = capture::colmapText(capture.cameras, capture.metres_per_unit);
  add(cameras.cameras);
  add(cameras.images);
  for (const capture::CaptureCamera& camera : capture.cameras)  // the texts cannot say it
    if (camera.distortion.skew != 0) add(camera.pinhole.name + " " + std::to_string(camera.distortion.skew));
  add(std::to_string(int(capture.background_kind)));
  for (const std::string& file : filesOf(capture.background_folder)) add(file);
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    add(sequence.name + " " + std::to_string(sequence.frame_count));
    for (const std::string& file : filesOf(sequence.folder)) add(file);
  }
  char text[240];
  std::snprintf(text, sizeof text, "%016llx %s\n", static_cast<unsigned long long>(hash), line);
  return text;
}

Result<std::string> checkedTarget(const ReconstructOptions& options) {
  std::error_code failed;
  fs::path target = fs::weakly_canonical(fs::absolute(options.folder, failed), failed);
  if (!target.has_filename()) target = target.parent_path();
  const auto bad = [&](const std::string& what) {
    return Error{ErrorId::InvalidArgument, options.folder + ": " + what};
  };
  if (const fs::path source = fs::canonical(options.capture_folder, failed); !failed) {
    if (within(target, source)) return bad("lies inside the capture that is read; choose a folder beside it");
    for (const char* ending : {"", ".part", ".work"})
      if (within(source, target.string() + ending))
        return bad("would replace the capture that is read; choose another output folder");
  }
  if (!fs::exists(target, failed)) return target.string();
  if (!fs::is_directory(target, failed)) return bad("exists and is not a folder; choose another output folder");
  if (fs::is_empty(target, failed) || fs::exists(target / kReportJson, failed)) return target.string();
  return bad("exists and was not written by reconstruct (no " + std::string(kReportJson) +
             " inside); choose another output folder");
}

Status FrameStore::open(const std::string& key, bool resume) const {
  std::error_code failed;
  const auto found = platform::readFile(keyPath());
  for (const std::string& folder : {workFolder(), resultFolder()}) {
    if (fs::exists(folder, failed) && !found.ok())
      return Error{ErrorId::InvalidArgument,
                   folder + ": exists and was not left by reconstruct; move it away or choose another output folder"};
  }
  const bool same = found.ok() && std::string(found.value().begin(), found.value().end()) == key;
  if (resume && found.ok() && !same) {
    return Error{ErrorId::InvalidArgument,
                 workFolder() +
                     ": was left by a run with other options, or the capture's pictures, plates or cameras "
                     "have changed since; repeat that run's options, or leave out --resume to begin anew"};
  }
  if (!resume || !same) {
    platform::removeFolder(workFolder());
    platform::removeFolder(resultFolder());
  }
  FOURDVT_TRY(platform::makeFolder(workFolder()));
  FOURDVT_TRY(platform::writeFileAtomic(keyPath(), key));
  return platform::makeFolder(resultFolder());
}

Status FrameStore::makeFolders(const std::string& sequence) const {
  FOURDVT_TRY(platform::makeFolder(resultFolder() + "/" + sequence + "/" + kMeshFolder));
  return platform::makeFolder(workFolder() + "/figures/" + sequence);
}

std::string FrameStore::meshPath(const std::string& sequence, uint32_t frame) const {
  return resultFolder() + "/" + sequence + "/" + kMeshFolder + "/" + frameName(frame) + ".ply";
}

std::string FrameStore::figuresPath(const std::string& sequence, uint32_t frame) const {
  return workFolder() + "/figures/" + sequence + "/" + frameName(frame) + ".json";
}

std::optional<FrameFigures> FrameStore::find(const std::string& sequence, uint32_t frame) const {
  std::error_code failed;
  if (!fs::exists(meshPath(sequence, frame), failed)) return std::nullopt;
  const std::string path = figuresPath(sequence, frame);
  const auto bytes = platform::readFile(path);
  if (!bytes.ok()) return std::nullopt;
  auto figures = parseFigures(std::string(bytes.value().begin(), bytes.value().end()), path);
  if (!figures.ok()) return std::nullopt;
  return figures.take();
}

Status FrameStore::save(const std::string& sequence, uint32_t frame, const TriangleMesh& mesh,
                        const FrameFigures& figures) const {
  TriangleMesh in_units = mesh;
  for (glm::vec3& p : in_units.positions) p /= float(metres_per_unit_);
  FOURDVT_TRY(platform::writeFileAtomic(meshPath(sequence, frame), capture::plyBytes(in_units)));
  return platform::writeFileAtomic(figuresPath(sequence, frame), figuresText(figures));
}

Result<TriangleMesh> FrameStore::loadMesh(const std::string& sequence, uint32_t frame) const {
  FOURDVT_ASSIGN(auto mesh, capture::readMeshFile(meshPath(sequence, frame)));
  for (glm::vec3& p : mesh.positions) p *= float(metres_per_unit_);
  return mesh;
}

Status FrameStore::finish() const {
  FOURDVT_TRY(platform::replaceFolder(resultFolder(), target_, workFolder() + "/previous"));
  platform::removeFolder(workFolder());
  return {};
}

}  // namespace fourdvt::reconstruct
