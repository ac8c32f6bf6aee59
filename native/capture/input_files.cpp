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

}  // namespace

uint64_t inputDigest(const Capture& capture, const CaptureSequence& sequence, uint32_t first, uint32_t end) {
  uint64_t hash = kFnv1aStart;
  for (const CaptureCamera& camera : capture.cameras) {
    const std::string& name = camera.pinhole.name;
    for (const std::string& stem : {name, matteStem(name)})
      if (const auto place = findPictures(sequence.folder, stem))
        hash = addPictures(hash, *place, sequence, name, first, end);
  }
  if (!sequence.packed_positions.empty()) return addFile(hash, sequence.packed_positions);
  for (uint32_t f = first; f < end && !sequence.mesh_pattern.empty(); ++f) hash = addFile(hash, meshPath(sequence, f));
  return hash;
}

uint64_t commonInputDigest(const Capture& capture) {
  uint64_t hash = addFile(kFnv1aStart, capture.folder + "/capture.json");
  for (const std::string& folder : {capture.cameras_folder, capture.background_folder})
    for (const fs::path& file : sortedEntries(folder))
      if (isFile(file.string())) hash = addFile(hash, file.string());
  return hash;
}

}  // namespace fourdvt::capture
