// SPDX-License-Identifier: Apache-2.0
// Keeps finished GOPs on disk, so that memory does not grow with the length and an interrupted bake can go on. Files
// are written atomically and checksummed; a damaged one counts as absent. They lie in a folder whose name is a hash of
// what they depend on, so that a process that bakes by an older plan cannot mix its own among them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bake/video/encode.h"
#include "bake/video/tile.h"
#include "package/stream_file.h"

namespace fourdvt::bake {

// Side in texels of the small layers 1 that the motion graph compares (TransitionOptions::atlas).
constexpr int kAtlasSide = 32;

struct GopArtefact {
  std::vector<EncodedGop> videos;     // [rendition] of the plan
  package::ChunkFrames frames;        // of a class: what its chunk is coded from once it is aligned; else empty
  std::vector<Image> atlases;         // [frame][member], RGB
  std::vector<uint8_t> picture_jpeg;  // first GOP of a class: its tiled picture
};

// Frame 0 of the first sequence, from which poster and still are made.
struct StillArtefact {
  I420Picture picture;          // tiled
  std::vector<uint8_t> labels;  // [layer][face]
  std::vector<uint8_t> texture_jpeg, tile_jpeg;
};

enum class Precision { Fine, Coarse };  // of a chunk's positions

class WorkFolder {
 public:
  WorkFolder() = default;
  // `key`: settingsKey. What an earlier run left stays only if `resume` is set and the keys agree; `on_restart` is
  // called if it is removed although `resume` is set. Errors: WriteFailed.
  static Result<WorkFolder> open(const std::string& path, const std::string& key, bool resume,
                                 const std::function<void()>& on_restart = {});
  // The folder as it is. Errors: InvalidArgument if it has another key.
  static Result<WorkFolder> join(const std::string& path, const std::string& key);
  // True if the folder has work of an earlier run with this key.
  static bool holds(const std::string& path, const std::string& key);
  // Removes the folder; its settings file, without which it is not taken for a work folder, goes last.
  static void remove(const std::string& path);
  // Whether a bake in this folder has finished a GOP, with whatever settings.
  static bool holdsGops(const std::string& path);
  bool hasGop(const std::string& sequence, uint32_t gop) const;
  Status saveGop(const std::string& sequence, uint32_t gop, const GopArtefact& artefact) const;
  Result<GopArtefact> loadGop(const std::string& sequence, uint32_t gop) const;  // Internal if damaged
  bool hasStill() const;
  Status saveStill(const StillArtefact& still) const;
  Result<StillArtefact> loadStill() const;
  // The bytes of a GOP's chunk, as package::encodeChunk or encodeCoarseChunk return them.
  bool hasChunk(const std::string& sequence, uint32_t gop) const;
  Status saveChunk(const std::string& sequence, uint32_t gop, const std::vector<uint8_t>& chunk,
                   Precision precision = Precision::Fine) const;
  Result<std::vector<uint8_t>> loadChunk(const std::string& sequence, uint32_t gop,
                                         Precision precision = Precision::Fine) const;  // Internal if damaged
  // Filled layers of a captured frame, kept until the classes that show it have been baked. What is absent or damaged
  // is an error, and can be drawn again.
  Status saveLayers(const std::string& sequence, uint32_t frame, const std::vector<Image>& layers) const;
  Result<std::vector<Image>> loadLayers(const std::string& sequence, uint32_t frame) const;
  void removeLayers() const;  // of all frames
  // Further results of the whole bake, such as "graph". What is absent or damaged is an error.
  Status saveResult(const std::string& name, const std::vector<uint8_t>& bytes) const;
  Result<std::vector<uint8_t>> loadResult(const std::string& name) const;
  const std::string& path() const { return root_; }
  // Folder for files of a stage's own.
  const std::string& filesFolder() const { return path_; }

 private:
  WorkFolder(const std::string& path, const std::string& key);
  std::string gopPath(const std::string& sequence, uint32_t gop) const;
  std::string chunkPath(const std::string& sequence, uint32_t gop, Precision precision) const;
  std::string layersPath(const std::string& sequence, uint32_t frame) const;
  std::string stillPath() const { return path_ + "/still.bin"; }
  std::string root_, path_;
};

}  // namespace fourdvt::bake
