// SPDX-License-Identifier: Apache-2.0
#include "bake/run/work_folder.h"

#include <filesystem>

#include "base/hash.h"
#include "base/text.h"
#include "platform/files.h"

namespace fourdvt::store {

void fields(Archive& a, encode::EncodedPacket& p) { a(p.frame, p.key, p.bytes); }
void fields(Archive& a, encode::EncodedGop& g) { a(g.parameter_sets, g.packets); }
void fields(Archive& a, encode::I420Picture& p) { a(p.width, p.height, p.y, p.u, p.v); }
// All fields except the alignment, which is measured later.
void fields(Archive& a, package::ChunkFrames& f) {
  a(f.frame_count, f.vertex_count, f.face_count, f.layer_count, f.member_count, f.reference_count, f.positions,
    f.labels, f.offsets, f.root);
}
void fields(Archive& a, bake::GopArtefact& g) { a(g.videos, g.frames, g.atlases, g.picture_jpeg); }
void fields(Archive& a, bake::StillArtefact& s) { a(s.picture, s.labels, s.texture_jpeg, s.tile_jpeg); }

}  // namespace fourdvt::store

namespace fourdvt::bake {
namespace {

constexpr const char* kLayersExtension = ".layers";

}  // namespace

Result<WorkFolder> WorkFolder::open(const std::string& path, const std::string& key, bool resume,
                                    const std::function<void()>& on_restart) {
  const auto found = store::keyOf(path);
  if (!resume || found != key) {
    if (resume && found && on_restart) on_restart();
    store::removeFolder(path);
  }
  WorkFolder folder(path, key);
  FOURDVT_TRY(store::setKey(path, key));
  FOURDVT_TRY(platform::makeFolder(folder.path_));
  return folder;
}

Result<WorkFolder> WorkFolder::join(const std::string& path, const std::string& key) {
  if (store::keyOf(path) == key) return WorkFolder(path, key);
  return Error{ErrorId::InvalidArgument, path + ": is not the folder of this plan any more; run `fourdvt plan` again"};
}

WorkFolder::WorkFolder(const std::string& path, const std::string& key)
    : root_(path), path_(path + "/baked_" + hexDigits(fnv1a(key))) {}

bool WorkFolder::holdsGops(const std::string& path) {
  std::error_code ignored;
  for (std::filesystem::recursive_directory_iterator file(path, ignored), end; !ignored && file != end;
       file.increment(ignored))
    if (file->path().extension() == ".gop") return true;
  return false;
}

std::string layersFile(const std::string& sequence, uint32_t frame) {
  return sequence + "." + std::to_string(frame) + kLayersExtension;
}

void WorkFolder::removeLayers() const {
  platform::removeEntries(path_, [](const std::string& name) { return name.ends_with(kLayersExtension); });
}

}  // namespace fourdvt::bake
