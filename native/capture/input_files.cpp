// SPDX-License-Identifier: Apache-2.0
#include "capture/input_files.h"

#include <chrono>
#include <filesystem>

#include "base/hash.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

uint64_t addFile(uint64_t hash, const std::string& path) {
  std::error_code ignored;
  const auto time = fs::last_write_time(path, ignored).time_since_epoch();
  const auto bytes = fs::file_size(path, ignored);
  return fnv1a(path + " " + std::to_string(bytes) + " " +
                   std::to_string(std::chrono::floor<std::chrono::seconds>(time).count()) + "\n",
               hash);
}

uint64_t addPictures(uint64_t hash, const PicturePlace& place, const CaptureSequence& sequence,
                     const std::string& camera, uint32_t first, uint32_t end) {
  if (!place.numbered) return addFile(hash, place.path);
  for (uint32_t f = first; f < end; ++f) hash = addFile(hash, framePath(place.path, sequence.pictureOf(camera, f)));
  return hash;
}

// Hashes a glTF and the buffer of its name.
uint64_t addMesh(uint64_t hash, const fs::path& path) {
  hash = addFile(hash, path.string());
  if (path.extension() != ".gltf") return hash;
  std::error_code ignored;
  const fs::path buffer = fs::weakly_canonical(path, ignored).replace_extension(".bin");
  return fs::exists(buffer, ignored) ? addFile(hash, buffer.string()) : hash;
}

uint64_t addMeshes(uint64_t hash, const CaptureSequence& sequence, uint32_t first, uint32_t end) {
  if (!sequence.packed_positions.empty()) return addFile(hash, sequence.packed_positions);
  for (uint32_t f = first; f < end && !sequence.mesh_pattern.empty(); ++f) hash = addMesh(hash, meshPath(sequence, f));
  return hash;
}

// Hashes files directly in a folder.
uint64_t addFolder(uint64_t hash, const std::string& folder) {
  for (const fs::path& file : sortedEntries(folder))
    if (isFile(file.string())) hash = addFile(hash, file.string());
  return hash;
}

}  // namespace

uint64_t inputDigest(const Capture& capture, const CaptureSequence& sequence, uint32_t first, uint32_t end) {
  uint64_t hash = kFnv1aStart;
  for (const CaptureCamera& camera : capture.cameras) {
    const std::string& name = camera.pinhole.name;
    for (const std::string& stem : {name, matteStem(name)})
      if (const auto place = findPictures(sequence.folder, stem))
        hash = addPictures(hash, *place, sequence, name, first, end);
  }
  return addMeshes(hash, sequence, first, end);
}

std::vector<std::string> videoFiles(const Capture& capture) {
  std::vector<std::string> out;
  for (const CaptureSequence& sequence : capture.sequences)
    for (const CaptureCamera& camera : capture.cameras)
      for (const std::string& stem : {camera.pinhole.name, matteStem(camera.pinhole.name)})
        if (const auto place = findPictures(sequence.folder, stem); place && !place->numbered)
          out.push_back(place->path);
  return out;
}

uint64_t meshDigest(const CaptureSequence& sequence) {
  return addMeshes(kFnv1aStart, sequence, 0, sequence.frame_count);
}

uint64_t soundDigest(const Capture& capture) {
  uint64_t hash = kFnv1aStart;
  for (const CaptureSequence& sequence : capture.sequences)
    if (sequence.sound) hash = addFile(hash, sequence.sound->path);
  for (const CaptureClass& c : capture.classes)
    if (c.footstep) hash = addFile(hash, c.footstep->path);
  return hash;
}

uint64_t commonInputDigest(const Capture& capture) {
  uint64_t hash = addFile(kFnv1aStart, capture.folder + "/capture.json");
  for (const std::string& folder : {capture.cameras_folder, capture.background_folder}) hash = addFolder(hash, folder);
  for (const CaptureCamera& camera : capture.cameras)  // several plates per camera
    hash = addFolder(hash, capture.background_folder + "/" + camera.pinhole.name);
  return hash;
}

}  // namespace fourdvt::capture
