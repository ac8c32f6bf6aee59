// SPDX-License-Identifier: Apache-2.0
#include "bake/run/character_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <set>
#include <vector>

#include "base/hash.h"
#include "base/text.h"
#include "package/character.h"
#include "platform/files.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace fourdvt::bake {
namespace {

std::string ffmpegVersion(unsigned v) {
  return std::to_string(v >> 16) + "." + std::to_string((v >> 8) & 255) + "." + std::to_string(v & 255);
}

// Header of final size: offsets are relative to its end, so that its size must not change.
Result<std::vector<uint8_t>> finalHeader(package::StreamIndex& index) {
  std::vector<uint8_t> header = package::writeStreamHeader(index);
  for (int attempt = 0; attempt < 4; ++attempt) {
    uint64_t offset = header.size();
    for (std::vector<package::ChunkEntry>* chunks : {&index.chunks, &index.coarse_chunks})
      for (package::ChunkEntry& chunk : *chunks) {
        chunk.offset = offset;
        offset += chunk.bytes;
      }
    std::vector<uint8_t> next = package::writeStreamHeader(index);
    const bool stable = next.size() == header.size();
    header = std::move(next);
    if (!stable) continue;
    if (package::keepsMemoryLimits(index)) return header;
    return Error{ErrorId::InvalidArgument,
                 "a group of pictures takes more memory than players allow; bake again with a smaller --gop"};
  }
  return Error{ErrorId::Internal, "the stream header's size does not settle"};
}

// Writes header and chunks into one file, with one chunk in memory at a time.
Status writeFile(const std::string& path, const std::vector<uint8_t>& header, const WorkFolder& work,
                 const StreamPlan& plan, bool coarse) {
  const auto gops = static_cast<uint32_t>(plan.gop_first_frames.size());
  std::FILE* file = std::fopen(path.c_str(), "wb");
  bool ok = file && std::fwrite(header.data(), 1, header.size(), file) == header.size();
  for (uint32_t c = 0; ok && c < (coarse ? 2 * gops : gops); ++c) {
    auto chunk =
        work.load<store::Bytes>(chunkFile(plan.name, c % gops, c < gops ? Precision::Fine : Precision::Coarse));
    if (!chunk) {
      std::fclose(file);
      return chunk.error();
    }
    ok = std::fwrite(chunk.value().data(), 1, chunk.value().size(), file) == chunk.value().size();
  }
  int code = ok ? 0 : errno;
  if (file && std::fclose(file) != 0 && ok) code = errno, ok = false;
  if (ok) return {};
  return Error{ErrorId::WriteFailed,
               path + ": cannot write: " + std::strerror(code) + "; free disk space or choose another output folder"};
}

// Writes the video of all GOPs of one rendition.
Result<encode::Mp4Samples> packVideo(const StreamPlan& plan, size_t rendition, const WorkFolder& work,
                                     const std::string& path) {
  const encode::EncodeSettings& settings = plan.renditions[rendition].encode;
  FOURDVT_TRY(encode::writeMp4(path, settings, static_cast<uint32_t>(plan.gop_first_frames.size()),
                               [&](uint32_t g) -> Result<encode::EncodedGop> {
                                 FOURDVT_ASSIGN(auto artefact, work.load<GopArtefact>(gopFile(plan.name, g)));
                                 if (rendition >= artefact.videos.size())
                                   return Error{ErrorId::Internal, path + ": a GOP lacks this rendition; bake again"};
                                 return std::move(artefact.videos[rendition]);
                               }));
  FOURDVT_ASSIGN(auto packed, encode::readMp4Samples(path, settings.fps, plan.gop_first_frames, plan.frameCount()));
  package::SampleTable& table = packed.table;
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    const package::ByteSpan span = table.videoOf(g);
    FOURDVT_ASSIGN(auto bytes, platform::readFileRange(path, span.offset, span.bytes));
    table.chunk_hash.push_back(fnv1a(bytes));
  }
  return packed;
}

}  // namespace

Result<std::vector<package::SampleTable>> packVideos(const StreamPlan& plan, const BakeRun& run,
                                                     package::Sequence& sequence) {
  struct Packed {
    package::Rendition rendition;
    package::SampleTable table;
  };
  std::vector<Packed> all;
  for (size_t r = plan.renditions.size(); r-- > 0;) {  // among files of equal size, the highest comes last
    package::Rendition& rendition = sequence.renditions[r];
    FOURDVT_ASSIGN(auto packed, packVideo(plan, r, run.work, run.job.resultFolder() + "/" + rendition.video_uri));
    FOURDVT_ASSIGN(rendition.video_uri, nameByContent(run.job.resultFolder(), rendition.video_uri));
    rendition.video_bytes = packed.file_bytes;
    rendition.codec = packed.codec;
    all.push_back({std::move(rendition), std::move(packed.table)});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Packed& a, const Packed& b) { return a.rendition.video_bytes < b.rendition.video_bytes; });
  std::vector<package::SampleTable> tables;
  sequence.renditions.clear();
  for (Packed& packed : all) {
    sequence.renditions.push_back(std::move(packed.rendition));
    tables.push_back(std::move(packed.table));
  }
  return tables;
}

Status writeStream(package::StreamIndex index, const BakeRun& run, const StreamPlan& plan, package::Sequence& s) {
  const std::string path = run.job.resultFolder() + "/" + s.stream_uri;
  FOURDVT_ASSIGN(auto header, finalHeader(index));
  FOURDVT_TRY(writeFile(path, header, run.work, plan, s.coarse_renditions > 0));
  s.stream_bytes = platform::fileBytes(path);
  s.stream_header_bytes = static_cast<uint32_t>(header.size());
  s.stream_header_hash = fnv1a(header);
  for (const package::ChunkEntry& chunk : index.coarse_chunks) s.coarse_bytes += chunk.bytes;
  FOURDVT_ASSIGN(s.stream_uri, nameByContent(run.job.resultFolder(), s.stream_uri));
  return {};
}

std::vector<std::pair<std::string, std::string>> encoderVersions() {
  return {{"libavcodec", ffmpegVersion(avcodec_version())}, {"libavformat", ffmpegVersion(avformat_version())}};
}

}  // namespace fourdvt::bake

namespace fourdvt::bake {

bool isFileName(const std::string& name) {
  constexpr const char* kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return !name.empty() && name[0] != '.' && name.find_first_not_of(kAllowed) == std::string::npos;
}

package::Character describeCharacter(const Job& job) {
  package::Character character;
  character.name = job.capture.name;
  if (job.fromCameras()) {
    character.appearance = package::AppearanceKind::Cameras;
    character.version = package::kCameraFormatVersion;
  } else {
    character.layer_count = job.options.layers;
    character.vertex_count = job.mesh.decoded.topology.vertex_count;
    character.face_count = job.mesh.decoded.topology.faceCount();
  }
  character.cameras = job.cameras;
  character.bounds = job.bounds;
  character.ground_y_m = job.capture.ground_y_m;
  character.length_scale = job.length_scale;
  character.mesh_uri = kMeshFile;
  character.mesh_bytes = job.mesh.bytes.size();
  character.mesh_hash = fnv1a(job.mesh.bytes);
  character.poster_uri = kPosterFile;
  return character;
}

package::Sequence describeStream(const StreamPlan& plan) {
  package::Sequence s;
  s.name = plan.name;
  s.frame_count = plan.frameCount();
  s.fps = plan.motion.fps;
  s.loop = plan.motion.loop;
  for (const ClassMember& member : plan.motion.members)
    s.root_velocity_mps += member.source->root_velocity_mps / double(plan.motion.members.size());
  s.stream_uri = plan.name + ".bin";
  s.members = plan.motion.manifest;
  s.space = plan.motion.space;
  s.detail_correlation = plan.detail_correlation;
  s.reference_count = static_cast<uint32_t>(plan.motion.reference_weights.size());
  s.layout_width = plan.cameras.width;
  s.layout_height = plan.cameras.height;
  for (const RenditionPlan& planned : plan.renditions) {
    package::Rendition& rendition = s.renditions.emplace_back();
    rendition.video_uri = plan.name + planned.suffix + ".mp4";
    rendition.width = planned.layout.width;
    rendition.height = planned.layout.height;
    rendition.layers = planned.layout.layers;
    rendition.barcode = planned.layout.barcode;
    rendition.tiles = planned.tiles;
  }
  return s;
}

}  // namespace fourdvt::bake

namespace fourdvt::bake {
namespace {

constexpr int kPlacedAtOnce = 5;  // retries, where processes finish the same job at once

namespace fs = std::filesystem;

// Collects the names of files in a manifest, directly or by the names of sequences and cameras.
class Names {
 public:
  explicit Names(const FlatJson& gltf) : gltf_(gltf) {}
  void addUri(const std::string& at) { add("", at + "/uri", ""); }
  void add(const std::string& before, const std::string& pointer, const std::string& after) {
    const auto name = gltf_.string(pointer);
    if (name && isFileName(before + *name + after)) files.insert(before + *name + after);
  }
  std::set<std::string> files;

 private:
  const FlatJson& gltf_;
};

void addSequence(const FlatJson& gltf, const std::string& at, Names& names) {
  names.addUri(at + "/stream");
  names.add("report_", at + "/name", ".jpg");
  for (int r = 0; gltf.has(at + "/renditions/" + std::to_string(r)); ++r)
    names.addUri(at + "/renditions/" + std::to_string(r));
  for (int e = 0; gltf.has(at + "/sound/encodings/" + std::to_string(e)); ++e)
    names.addUri(at + "/sound/encodings/" + std::to_string(e));
}

// Files of the bake that made the folder; none without a bake's manifest.
std::set<std::string> bakedFiles(const std::string& folder) {
  const auto read = platform::readJsonFlat(folder + "/" + kManifestFile);
  const std::string at = std::string("/extensions/") + package::kExtensionName;
  if (!read || !read.value().has(at)) return {};
  const FlatJson& gltf = read.value();
  Names names(gltf);
  for (const char* part : {"/mesh", "/poster", "/graph", "/room", "/start"}) names.addUri(at + part);
  names.addUri("/images/0");
  for (int s = 0; gltf.has(at + "/sequences/" + std::to_string(s)); ++s)
    addSequence(gltf, at + "/sequences/" + std::to_string(s), names);
  for (int c = 0; gltf.has(at + "/cameras/" + std::to_string(c)); ++c)
    names.add("report_outline_", at + "/cameras/" + std::to_string(c) + "/name", ".jpg");
  for (const std::string file : {"report.html", "report.json", "report_tiles.jpg"}) names.files.insert(file);
  for (const std::string file : {"/cameras.txt", "/images.txt"}) names.files.insert(kRefinedCameras + file);
  return names.files;
}

// Files in `from` in the order of moving: new names, then those that replace a file, then the manifest.
std::vector<std::string> inOrder(const std::string& from, const std::string& to) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(from, error), end; entry != end; entry.increment(error))
    if (!entry->is_directory(error)) files.push_back(fs::relative(entry->path(), from, error).string());
  const auto rank = [&](const std::string& file) {
    return file == kManifestFile ? 2 : fs::exists(to + "/" + file, error) ? 1 : 0;
  };
  std::sort(files.begin(), files.end());
  std::stable_sort(files.begin(), files.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return files;
}

// Replaces atomically: readers see the old file or the new one. The folder may be a link to another file system.
Status move(const std::string& from, const std::string& to) {
  std::error_code error;
  FOURDVT_TRY(platform::makeFolder(fs::path(to).parent_path().string()));
  fs::rename(from, to, error);
  if (error == std::errc::cross_device_link) {
    FOURDVT_ASSIGN(const auto bytes, platform::readFile(from));
    return platform::writeFileAtomic(to, bytes);
  }
  if (!error) return {};
  return Error{ErrorId::WriteFailed, to + ": cannot write: " + error.message() + "; choose another output folder"};
}

void removeFiles(const std::string& folder, const std::set<std::string>& files) {
  std::error_code ignored;
  for (const std::string& file : files)
    if (!fs::is_directory(folder + "/" + file, ignored)) fs::remove(folder + "/" + file, ignored);
  platform::removeIfEmpty(folder + "/" + kRefinedCameras);
}

// Moves the files in order; a failure takes back those with new names.
Status moveAll(const std::vector<std::string>& files, const std::string& from, const std::string& to) {
  std::set<std::string> added;
  for (const std::string& file : files) {
    std::error_code ignored;
    const bool is_new = !fs::exists(to + "/" + file, ignored);
    if (const Status moved = move(from + "/" + file, to + "/" + file); !moved.ok()) {
      removeFiles(to, added);
      return moved;
    }
    if (is_new) added.insert(file);
  }
  return {};
}

}  // namespace

Status publish(const std::string& from, const std::string& to) {
  std::error_code error;
  if (!fs::exists(to, error)) {
    const Status placed = platform::replaceFolder(from, to, from + ".previous");
    if (placed.ok() || !fs::exists(to, error)) return placed;  // else another process was earlier
  }
  const std::vector<std::string> files = inOrder(from, to);
  std::set<std::string> old = bakedFiles(to);
  FOURDVT_TRY(moveAll(files, from, to));
  for (const std::string& file : files) old.erase(file);
  removeFiles(to, old);
  platform::removeFolder(from);
  return {};
}

Status publishReport(const std::string& from, const std::string& to) {
  const std::string previous = from + ".previous";
  Status placed = platform::replaceFolder(from, to, previous);
  for (int again = 0; again < kPlacedAtOnce && !placed.ok(); ++again)  // another process replaces it, too
    placed = platform::replaceFolder(from, to, previous);
  platform::removeFolder(previous);
  return placed;
}

}  // namespace fourdvt::bake

namespace fourdvt::bake {
namespace {

constexpr uint64_t kPartBytes = 1 << 20;

Result<uint64_t> hashOf(const std::string& path) {
  const uint64_t bytes = platform::fileBytes(path);
  uint64_t hash = kFnv1aStart;
  for (uint64_t at = 0; at < bytes; at += kPartBytes) {
    FOURDVT_ASSIGN(const auto part, platform::readFileRange(path, at, std::min(kPartBytes, bytes - at)));
    hash = fnv1a(part, hash);
  }
  return hash;
}

}  // namespace

std::string contentName(const std::string& name, uint64_t hash) {
  return std::string(name).insert(name.rfind('.'), "." + hexDigits(hash).substr(0, 8));
}

Result<std::string> writeNamed(const std::string& folder, const std::string& name, std::span<const uint8_t> bytes) {
  std::string named = contentName(name, fnv1a(bytes));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/" + named, bytes));
  return named;
}

Result<std::string> nameByContent(const std::string& folder, const std::string& name) {
  FOURDVT_ASSIGN(const uint64_t hash, hashOf(folder + "/" + name));
  std::string named = contentName(name, hash);
  std::error_code error;
  std::filesystem::rename(folder + "/" + name, folder + "/" + named, error);
  if (error) return Error{ErrorId::WriteFailed, folder + "/" + named + ": cannot write: " + error.message()};
  return named;
}

}  // namespace fourdvt::bake
