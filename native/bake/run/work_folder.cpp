// SPDX-License-Identifier: Apache-2.0
#include "bake/run/work_folder.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/bytes.h"
#include "base/hash.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "store/checked_file.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kLayersExtension = ".layers";
constexpr const char* kKeyFile = "/settings.txt";

void putBytes(ByteWriter& out, const std::vector<uint8_t>& bytes) {
  out.u32(static_cast<uint32_t>(bytes.size()));
  out.bytes(bytes);
}

std::vector<uint8_t> takeBytes(ByteReader& in) {
  const auto part = in.bytes(in.u32());
  return {part.begin(), part.end()};
}

template <class T>
void putVector(ByteWriter& out, const std::vector<T>& values) {
  out.u32(static_cast<uint32_t>(values.size()));
  out.bytes({reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)});
}

template <class T>
std::vector<T> takeVector(ByteReader& in) {
  const uint32_t count = in.u32();
  const auto part = in.bytes(count * sizeof(T));
  std::vector<T> values(in.ok() ? count : 0);
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), part.data(), part.size());
  return values;
}

void putVideo(ByteWriter& out, const EncodedGop& video) {
  putBytes(out, video.parameter_sets);
  out.u32(static_cast<uint32_t>(video.packets.size()));
  for (const EncodedPacket& packet : video.packets) {
    out.u32(packet.frame);
    out.u8(packet.key);
    putBytes(out, packet.bytes);
  }
}

EncodedGop takeVideo(ByteReader& in) {
  EncodedGop video;
  video.parameter_sets = takeBytes(in);
  for (uint32_t left = in.u32(); left > 0 && in.ok(); --left) {
    EncodedPacket packet;
    packet.frame = in.u32();
    packet.key = in.u8() != 0;
    packet.bytes = takeBytes(in);
    video.packets.push_back(std::move(packet));
  }
  return video;
}

// Does not include the alignment, which is measured later.
void putFrames(ByteWriter& out, const package::ChunkFrames& f) {
  for (uint32_t count : {f.frame_count, f.vertex_count, f.face_count, f.layer_count, f.member_count, f.reference_count})
    out.u32(count);
  putVector(out, f.positions);
  putVector(out, f.labels);
  putVector(out, f.offsets);
  putVector(out, f.root);
}

package::ChunkFrames takeFrames(ByteReader& in) {
  package::ChunkFrames f;
  for (uint32_t* count :
       {&f.frame_count, &f.vertex_count, &f.face_count, &f.layer_count, &f.member_count, &f.reference_count})
    *count = in.u32();
  f.positions = takeVector<glm::ivec3>(in);
  f.labels = takeVector<uint8_t>(in);
  f.offsets = takeVector<glm::ivec3>(in);
  f.root = takeVector<glm::vec3>(in);
  return f;
}

void putAtlases(ByteWriter& out, const std::vector<Image>& atlases) {
  out.u32(static_cast<uint32_t>(atlases.size()));
  for (const Image& atlas : atlases) out.bytes(atlas.pixels);
}

std::vector<Image> takeAtlases(ByteReader& in) {
  std::vector<Image> atlases;
  for (uint32_t left = in.u32(); left > 0 && in.ok(); --left) {
    Image atlas(kAtlasSide, kAtlasSide, 3);
    const auto part = in.bytes(atlas.pixels.size());
    if (in.ok()) std::copy(part.begin(), part.end(), atlas.pixels.begin());
    atlases.push_back(std::move(atlas));
  }
  return atlases;
}

}  // namespace

Result<WorkFolder> WorkFolder::open(const std::string& path, const std::string& key, bool resume,
                                    const std::function<void()>& on_restart) {
  const std::string key_path = path + kKeyFile;
  if (!resume || !holds(path, key)) {
    std::error_code none;
    if (resume && std::filesystem::exists(key_path, none) && on_restart) on_restart();
    remove(path);
  }
  WorkFolder folder(path, key);
  FOURDVT_TRY(platform::makeFolder(path));
  FOURDVT_TRY(platform::writeFileAtomic(key_path, key));
  FOURDVT_TRY(platform::makeFolder(folder.path_));
  return folder;
}

Result<WorkFolder> WorkFolder::join(const std::string& path, const std::string& key) {
  if (holds(path, key)) return WorkFolder(path, key);
  return Error{ErrorId::InvalidArgument, path + ": is not the folder of this plan any more; run `fourdvt plan` again"};
}

bool WorkFolder::holds(const std::string& path, const std::string& key) {
  const auto bytes = platform::readFile(path + kKeyFile);
  return bytes && std::string(bytes.value().begin(), bytes.value().end()) == key;
}

void WorkFolder::remove(const std::string& path) { platform::removeFolder(path, kKeyFile + 1); }

WorkFolder::WorkFolder(const std::string& path, const std::string& key) : root_(path) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(key)));
  path_ = path + "/baked_" + digits;
}

bool WorkFolder::holdsGops(const std::string& path) {
  std::error_code ignored;
  for (std::filesystem::recursive_directory_iterator file(path, ignored), end; !ignored && file != end;
       file.increment(ignored))
    if (file->path().extension() == ".gop") return true;
  return false;
}

Status WorkFolder::saveResult(const std::string& name, const std::vector<uint8_t>& bytes) const {
  return store::saveChecked(path_ + "/" + name + ".result", bytes);
}

Result<std::vector<uint8_t>> WorkFolder::loadResult(const std::string& name) const {
  return store::loadChecked(path_ + "/" + name + ".result");
}

std::string WorkFolder::gopPath(const std::string& sequence, uint32_t gop) const {
  return path_ + "/" + sequence + "." + std::to_string(gop) + ".gop";
}

bool WorkFolder::hasGop(const std::string& sequence, uint32_t gop) const {
  return store::loadChecked(gopPath(sequence, gop)).ok();
}

Status WorkFolder::saveGop(const std::string& sequence, uint32_t gop, const GopArtefact& artefact) const {
  ByteWriter out;
  out.u32(static_cast<uint32_t>(artefact.videos.size()));
  for (const EncodedGop& video : artefact.videos) putVideo(out, video);
  putFrames(out, artefact.frames);
  putAtlases(out, artefact.atlases);
  putBytes(out, artefact.picture_jpeg);
  return store::saveChecked(gopPath(sequence, gop), out.data());
}

Result<GopArtefact> WorkFolder::loadGop(const std::string& sequence, uint32_t gop) const {
  FOURDVT_ASSIGN(auto bytes, store::loadChecked(gopPath(sequence, gop)));
  ByteReader in(bytes);
  GopArtefact artefact;
  for (uint32_t left = in.u32(); left > 0 && in.ok(); --left) artefact.videos.push_back(takeVideo(in));
  artefact.frames = takeFrames(in);
  artefact.atlases = takeAtlases(in);
  artefact.picture_jpeg = takeBytes(in);
  if (!in.ok() || in.remaining() != 0) return store::damagedFile(gopPath(sequence, gop));
  return artefact;
}

std::string WorkFolder::chunkPath(const std::string& sequence, uint32_t gop, Precision precision) const {
  return path_ + "/" + sequence + "." + std::to_string(gop) + (precision == Precision::Fine ? ".chunk" : ".coarse");
}

bool WorkFolder::hasChunk(const std::string& sequence, uint32_t gop) const {
  return store::loadChecked(chunkPath(sequence, gop, Precision::Fine)).ok();
}

Status WorkFolder::saveChunk(const std::string& sequence, uint32_t gop, const std::vector<uint8_t>& chunk,
                             Precision precision) const {
  ByteWriter out;
  out.bytes(chunk);
  return store::saveChecked(chunkPath(sequence, gop, precision), out.data());
}

Result<std::vector<uint8_t>> WorkFolder::loadChunk(const std::string& sequence, uint32_t gop,
                                                   Precision precision) const {
  return store::loadChecked(chunkPath(sequence, gop, precision));
}

std::string WorkFolder::layersPath(const std::string& sequence, uint32_t frame) const {
  return path_ + "/" + sequence + "." + std::to_string(frame) + kLayersExtension;
}

Status WorkFolder::saveLayers(const std::string& sequence, uint32_t frame, const std::vector<Image>& layers) const {
  ByteWriter out;
  out.u32(static_cast<uint32_t>(layers.size()));
  for (const Image& layer : layers) {
    for (int number : {layer.width, layer.height, layer.channels}) out.u32(static_cast<uint32_t>(number));
    putBytes(out, layer.pixels);
  }
  out.u64(fnv1a(out.data()));
  const std::string path = layersPath(sequence, frame);
  std::ofstream file(path, std::ios::binary);  // the hash finds half a file: no need to wait for the disk
  file.write(reinterpret_cast<const char*>(out.data().data()), static_cast<std::streamsize>(out.data().size()));
  file.close();
  if (file) return {};
  return Error{ErrorId::WriteFailed, path + ": cannot be written; free some space"};
}

Result<std::vector<Image>> WorkFolder::loadLayers(const std::string& sequence, uint32_t frame) const {
  FOURDVT_ASSIGN(auto bytes, store::loadChecked(layersPath(sequence, frame)));
  ByteReader in(bytes);
  std::vector<Image> layers;
  for (uint32_t left = in.u32(); left > 0 && in.ok(); --left) {
    Image layer;
    for (int* number : {&layer.width, &layer.height, &layer.channels}) *number = static_cast<int>(in.u32());
    layer.pixels = takeBytes(in);
    layers.push_back(std::move(layer));
  }
  if (!in.ok() || in.remaining() != 0) return store::damagedFile(layersPath(sequence, frame));
  return layers;
}

void WorkFolder::removeLayers() const {
  std::error_code ignored;
  std::vector<std::filesystem::path> found;
  for (std::filesystem::directory_iterator file(path_, ignored), end; file != end; file.increment(ignored))
    if (file->path().extension() == kLayersExtension) found.push_back(file->path());
  for (const std::filesystem::path& path : found) std::filesystem::remove(path, ignored);
}

bool WorkFolder::hasStill() const { return store::loadChecked(stillPath()).ok(); }

Status WorkFolder::saveStill(const StillArtefact& still) const {
  ByteWriter out;
  out.u32(still.picture.width);
  out.u32(still.picture.height);
  putBytes(out, still.picture.y);
  putBytes(out, still.picture.u);
  putBytes(out, still.picture.v);
  putBytes(out, still.labels);
  putBytes(out, still.texture_jpeg);
  putBytes(out, still.tile_jpeg);
  return store::saveChecked(stillPath(), out.data());
}

Result<StillArtefact> WorkFolder::loadStill() const {
  FOURDVT_ASSIGN(auto bytes, store::loadChecked(stillPath()));
  ByteReader in(bytes);
  StillArtefact still;
  still.picture.width = static_cast<int>(in.u32());
  still.picture.height = static_cast<int>(in.u32());
  still.picture.y = takeBytes(in);
  still.picture.u = takeBytes(in);
  still.picture.v = takeBytes(in);
  still.labels = takeBytes(in);
  still.texture_jpeg = takeBytes(in);
  still.tile_jpeg = takeBytes(in);
  if (!in.ok() || in.remaining() != 0) return store::damagedFile(stillPath());
  return still;
}

}  // namespace fourdvt::bake
