// SPDX-License-Identifier: Apache-2.0
// Stores finished GOPs on disk, so that memory does not grow with the length and an interrupted bake can resume. The
// files (store/folder.h) lie in a folder named by a hash of their inputs, so that a process with an older plan cannot
// mix in its own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "encode/encoder.h"
#include "encode/tile.h"
#include "package/stream_file.h"
#include "store/folder.h"

namespace fourdvt::bake {

// Side in texels of the small layers 1 that the motion graph compares (TransitionOptions::atlas).
constexpr int kAtlasSide = 32;

struct GopArtefact {
  std::vector<encode::EncodedGop> videos;  // [rendition] of the plan
  package::ChunkFrames frames;             // input of a class's chunk, coded after alignment; else empty
  std::vector<Image> atlases;              // [frame][member], RGB
  std::vector<uint8_t> picture_jpeg;       // first GOP of a class: its tiled picture
};

// Frame 0 of the first sequence, for poster and still.
struct StillArtefact {
  encode::I420Picture picture;  // tiled
  std::vector<uint8_t> labels;  // [layer][face]
  std::vector<uint8_t> texture_jpeg, tile_jpeg;
};

enum class Precision { Fine, Coarse };  // quantisation of a chunk's positions

class WorkFolder {
 public:
  WorkFolder() = default;
  // `key`: settingsKey. Results of an earlier run stay only if `resume` is set and the keys agree; `on_restart` is
  // called if they are removed although `resume` is set. Errors: WriteFailed.
  static Result<WorkFolder> open(const std::string& path, const std::string& key, bool resume,
                                 const std::function<void()>& on_restart = {});
  // Opens the folder unchanged. Errors: InvalidArgument if it has another key.
  static Result<WorkFolder> join(const std::string& path, const std::string& key);
  // True if a bake in this folder has finished a GOP, with any settings.
  static bool holdsGops(const std::string& path);

  // False for a damaged file too.
  bool has(const std::string& file) const { return store::loadBytes(pathOf(file)).ok(); }
  template <class T>
  Status save(const std::string& file, const T& value, store::Written written = store::Written::ToDisk) const {
    return store::save(pathOf(file), value, written);
  }
  template <class T>
  Result<T> load(const std::string& file) const {
    return store::load<T>(pathOf(file));
  }
  void removeLayers() const;  // removes the layers of all frames
  const std::string& path() const { return root_; }
  // Path of a file that belongs to one stage.
  std::string pathOf(const std::string& file) const { return path_ + "/" + file; }

 private:
  WorkFolder(const std::string& path, const std::string& key);
  std::string root_, path_;
};

// Names of the files of a GopArtefact and of a StillArtefact.
inline std::string gopFile(const std::string& stream, uint32_t gop) {
  return stream + "." + std::to_string(gop) + ".gop";
}
inline constexpr const char* kStillFile = "still.bin";
// Bytes of a GOP's chunk, from package::encodeChunk.
inline std::string chunkFile(const std::string& stream, uint32_t gop, Precision precision = Precision::Fine) {
  return stream + "." + std::to_string(gop) + (precision == Precision::Fine ? ".chunk" : ".coarse");
}
// Filled layers of a captured frame, a vector of pictures, kept until the classes that show it have been baked.
// Missing or damaged ones are rendered again.
std::string layersFile(const std::string& sequence, uint32_t frame);

}  // namespace fourdvt::bake

namespace fourdvt::store {

void fields(Archive& a, bake::GopArtefact& g);
void fields(Archive& a, bake::StillArtefact& s);

}  // namespace fourdvt::store
