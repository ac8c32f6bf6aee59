// SPDX-License-Identifier: Apache-2.0
#include "bake/work_folder.h"

#include "bake/output.h"
#include "base/bytes.h"

namespace fourdvt::bake {
namespace {

// File: payload, then its FNV-1a 64.
uint64_t checksum(std::span<const uint8_t> bytes) {
  uint64_t hash = 14695981039346656037ull;
  for (uint8_t b : bytes) hash = (hash ^ b) * 1099511628211ull;
  return hash;
}

Status save(const std::string& path, ByteWriter& out) {
  out.u64(checksum(out.data()));
  return writeFile(path, out.data());
}

Error damaged(const std::string& path) { return {ErrorId::Internal, path + ": damaged; bake again without --resume"}; }

Result<std::vector<uint8_t>> load(const std::string& path) {
  auto read = readFile(path);
  if (!read) return read.error();
  std::vector<uint8_t> bytes = read.take();
  if (bytes.size() < 8) return damaged(path);
  const std::span<const uint8_t> payload(bytes.data(), bytes.size() - 8);
  ByteReader tail(std::span<const uint8_t>(bytes).subspan(payload.size()));
  if (tail.u64() != checksum(payload)) return damaged(path);
  bytes.resize(payload.size());
  return bytes;
}

void putBytes(ByteWriter& out, const std::vector<uint8_t>& bytes) {
  out.u32(static_cast<uint32_t>(bytes.size()));
  out.bytes(bytes);
}

std::vector<uint8_t> takeBytes(ByteReader& in) {
  const auto part = in.bytes(in.u32());
  return {part.begin(), part.end()};
}

}  // namespace

Result<WorkFolder> WorkFolder::open(const std::string& path, const std::string& key, bool resume) {
  WorkFolder folder;
  folder.path_ = path;
  const std::string key_path = path + "/settings.txt";
  bool keep = false;
  if (auto old = readFile(key_path); resume && old.ok())
    keep = std::string(old.value().begin(), old.value().end()) == key;
  if (!keep) removeFolder(path);
  FOURDVT_TRY(makeFolder(path));
  FOURDVT_TRY(writeFile(key_path, key));
  return folder;
}

std::string WorkFolder::gopPath(const std::string& sequence, uint32_t gop) const {
  return path_ + "/" + sequence + "." + std::to_string(gop) + ".gop";
}

bool WorkFolder::hasGop(const std::string& sequence, uint32_t gop) const { return load(gopPath(sequence, gop)).ok(); }

Status WorkFolder::saveGop(const std::string& sequence, uint32_t gop, const GopArtefact& artefact) const {
  ByteWriter out;
  putBytes(out, artefact.video.parameter_sets);
  out.u32(static_cast<uint32_t>(artefact.video.packets.size()));
  for (const EncodedPacket& packet : artefact.video.packets) {
    out.u32(packet.frame);
    out.u8(packet.key);
    putBytes(out, packet.bytes);
  }
  putBytes(out, artefact.chunk);
  return save(gopPath(sequence, gop), out);
}

Result<GopArtefact> WorkFolder::loadGop(const std::string& sequence, uint32_t gop) const {
  auto bytes = load(gopPath(sequence, gop));
  if (!bytes) return bytes.error();
  ByteReader in(bytes.value());
  GopArtefact artefact;
  artefact.video.parameter_sets = takeBytes(in);
  for (uint32_t left = in.u32(); left > 0 && in.ok(); --left) {
    EncodedPacket packet;
    packet.frame = in.u32();
    packet.key = in.u8() != 0;
    packet.bytes = takeBytes(in);
    artefact.video.packets.push_back(std::move(packet));
  }
  artefact.chunk = takeBytes(in);
  if (!in.ok() || in.remaining() != 0) return damaged(gopPath(sequence, gop));
  return artefact;
}

bool WorkFolder::hasStill() const { return load(stillPath()).ok(); }

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
  return save(stillPath(), out);
}

Result<StillArtefact> WorkFolder::loadStill() const {
  auto bytes = load(stillPath());
  if (!bytes) return bytes.error();
  ByteReader in(bytes.value());
  StillArtefact still;
  still.picture.width = static_cast<int>(in.u32());
  still.picture.height = static_cast<int>(in.u32());
  still.picture.y = takeBytes(in);
  still.picture.u = takeBytes(in);
  still.picture.v = takeBytes(in);
  still.labels = takeBytes(in);
  still.texture_jpeg = takeBytes(in);
  still.tile_jpeg = takeBytes(in);
  if (!in.ok() || in.remaining() != 0) return damaged(stillPath());
  return still;
}

}  // namespace fourdvt::bake
