// SPDX-License-Identifier: Apache-2.0
#include "bake/assemble.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "bake/mp4.h"
#include "bake/output.h"
#include "bake/poster.h"
#include "base/bytes.h"
#include "package/writer.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kGenerator = "fourdvt 0.1.0";
constexpr const char* kMesh = "mesh.bin";
constexpr const char* kTexture = "texture.jpg";
constexpr const char* kPoster = "poster.webp";
constexpr const char* kTiles = "report_tiles.jpg";

struct ChunkBytes {
  uint32_t total = 0, positions = 0;
};

// A chunk opens with the length of its coded positions (FORMAT.md).
ChunkBytes measure(const std::vector<uint8_t>& chunk) {
  return {static_cast<uint32_t>(chunk.size()), ByteReader(chunk).u32()};
}

struct PackedSequence {
  package::Sequence manifest;
  ReportSequence report;
};

std::string ffmpegVersion(unsigned v) {
  return std::to_string(v >> 16) + "." + std::to_string((v >> 8) & 255) + "." + std::to_string(v & 255);
}

package::StreamIndex makeIndex(const Job& job, const SequencePlan& plan, const std::vector<ChunkBytes>& chunk_bytes,
                               package::SampleTable table) {
  package::StreamIndex index;
  index.frame_count = plan.source->frame_count;
  index.vertex_count = job.mesh.decoded.topology.vertex_count;
  index.face_count = job.mesh.decoded.topology.faceCount();
  index.layer_count = static_cast<uint32_t>(job.options.layers);
  index.position_origin = job.bounds.min;
  index.position_step_m = static_cast<float>(job.options.position_step_m);
  index.renditions.push_back(std::move(table));
  for (size_t g = 0; g < chunk_bytes.size(); ++g) {
    const uint32_t first = plan.gop_first_frames[g];
    index.chunks.push_back({first, plan.gopEnd(g) - first, 0, chunk_bytes[g].total});
  }
  return index;
}

// Offsets follow the header, whose size they must not change.
Result<std::vector<uint8_t>> finalHeader(package::StreamIndex& index) {
  std::vector<uint8_t> header = package::writeStreamHeader(index);
  for (int attempt = 0; attempt < 4; ++attempt) {
    uint64_t offset = header.size();
    for (package::ChunkEntry& chunk : index.chunks) {
      chunk.offset = offset;
      offset += chunk.bytes;
    }
    std::vector<uint8_t> next = package::writeStreamHeader(index);
    const bool stable = next.size() == header.size();
    header = std::move(next);
    if (stable) return header;
  }
  return Error{ErrorId::Internal, "the stream header's size does not settle"};
}

// Header and chunks in one file, a chunk in memory at a time.
Status writeStream(const std::string& path, const std::vector<uint8_t>& header, const WorkFolder& work,
                   const std::string& sequence, size_t gop_count) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  bool ok = file && std::fwrite(header.data(), 1, header.size(), file) == header.size();
  for (uint32_t g = 0; ok && g < gop_count; ++g) {
    auto artefact = work.loadGop(sequence, g);
    if (!artefact) {
      std::fclose(file);
      return artefact.error();
    }
    const std::vector<uint8_t>& chunk = artefact.value().chunk;
    ok = std::fwrite(chunk.data(), 1, chunk.size(), file) == chunk.size();
  }
  int code = ok ? 0 : errno;
  if (file && std::fclose(file) != 0 && ok) code = errno, ok = false;
  if (ok) return {};
  return Error{ErrorId::WriteFailed,
               path + ": cannot write: " + std::strerror(code) + "; free disk space or choose another output folder"};
}

Result<Mp4Samples> packVideo(const Job& job, const SequencePlan& plan, const WorkFolder& work, const std::string& path,
                             std::vector<ChunkBytes>& chunk_bytes) {
  const std::string& name = plan.source->name;
  FOURDVT_TRY(writeMp4(path, job.encode, static_cast<uint32_t>(plan.gop_first_frames.size()),
                       [&](uint32_t g) -> Result<EncodedGop> {
                         auto artefact = work.loadGop(name, g);
                         if (!artefact) return artefact.error();
                         chunk_bytes.push_back(measure(artefact.value().chunk));
                         return std::move(artefact.value().video);
                       }));
  return readMp4Samples(path, job.encode.fps, plan.gop_first_frames, plan.source->frame_count);
}

Result<PackedSequence> packSequence(const Job& job, const SequencePlan& plan, const WorkFolder& work) {
  const capture::CaptureSequence& source = *plan.source;
  const std::string folder = job.resultFolder() + "/";
  PackedSequence out;
  package::Sequence& s = out.manifest;
  package::Rendition rendition;
  rendition.video_uri = source.name + ".mp4";
  s.stream_uri = source.name + ".bin";
  std::vector<ChunkBytes> chunk_bytes;
  auto packed = packVideo(job, plan, work, folder + rendition.video_uri, chunk_bytes);
  if (!packed) return packed.error();
  package::StreamIndex index = makeIndex(job, plan, chunk_bytes, std::move(packed.value().table));
  auto header = finalHeader(index);
  if (!header) return header.error();
  FOURDVT_TRY(writeStream(folder + s.stream_uri, header.value(), work, source.name, chunk_bytes.size()));
  rendition.video_bytes = packed.value().file_bytes;
  rendition.codec = packed.value().codec;
  rendition.width = job.layout.width;
  rendition.height = job.layout.height;
  rendition.layers = job.layout.layers;
  rendition.barcode = job.layout.barcode;
  s.name = source.name;
  s.frame_count = source.frame_count;
  s.fps = job.capture.fps;
  s.loop = source.loop;
  s.root_velocity_mps = source.root_velocity_mps;
  s.stream_bytes = fileBytes(folder + s.stream_uri);
  s.stream_header_bytes = static_cast<uint32_t>(header.value().size());
  ReportSequence& r = out.report;
  r = {s.name, s.frame_count, static_cast<uint32_t>(chunk_bytes.size()), s.fps, s.loop, rendition.video_bytes};
  r.index_bytes = header.value().size();
  for (const ChunkBytes& bytes : chunk_bytes) {
    r.geometry_bytes += bytes.positions;
    r.label_bytes += bytes.total - bytes.positions;
  }
  s.renditions.push_back(std::move(rendition));
  return out;
}

package::Character describeCharacter(const Job& job) {
  package::Character character;
  character.name = job.capture.name;
  character.layer_count = job.options.layers;
  character.vertex_count = job.mesh.decoded.topology.vertex_count;
  character.face_count = job.mesh.decoded.topology.faceCount();
  character.cameras = job.cameras;
  character.bounds = job.bounds;
  character.ground_y_m = job.capture.ground_y_m;
  character.mesh_uri = kMesh;
  character.mesh_bytes = job.mesh.bytes.size();
  character.poster_uri = kPoster;
  return character;
}

Status writeStills(const Job& job, const WorkFolder& work, gpu::Device& device, const package::Character& character) {
  const std::string folder = job.resultFolder() + "/";
  auto still = work.loadStill();
  if (!still) return still.error();
  FOURDVT_TRY(writeFile(folder + kTexture, still.value().texture_jpeg));
  FOURDVT_TRY(writeFile(folder + kTiles, still.value().tile_jpeg));
  auto positions = capture::readMeshFrame(job.capture, *job.sequences[0].source, 0);
  if (!positions) return positions.error();
  auto poster =
      renderPoster(device, character, job.mesh.decoded, still.value(), reordered(job.mesh, positions.value()));
  if (!poster) return poster.error();
  auto webp = encodePicture(poster.value(), ".webp", 85);
  if (!webp) return webp.error();
  return writeFile(folder + kPoster, webp.value());
}

void describe(const Job& job, const package::Character& character, ReportInput& report) {
  const std::string folder = job.resultFolder() + "/";
  report.options = job.options;
  report.capture_name = job.capture.name;
  report.credit = job.capture.credit;
  report.generator = kGenerator;
  report.codec = character.sequences.front().renditions.front().codec;
  report.cameras = static_cast<uint32_t>(job.cameras.size());
  report.vertices = character.vertex_count;
  report.faces = character.face_count;
  report.picture_width = job.layout.width;
  report.picture_height = job.layout.height;
  report.versions = {{"libavcodec", ffmpegVersion(avcodec_version())},
                     {"libavformat", ffmpegVersion(avformat_version())}};
  const std::string first = job.sequences[0].source->name + ", frame 0";
  report.pictures = {{kPoster, "The character, " + first + ", as the page shows it first."},
                     {kTiles, "The video picture of " + first + ": all layers and the barcode."}};
  auto& bytes = report.figures.bytes_by_part;
  for (const char* name : {kMesh, kTexture, kPoster, "character.gltf"}) bytes[name] = fileBytes(folder + name);
  for (const package::Sequence& s : character.sequences) {
    bytes[s.stream_uri] = s.stream_bytes;
    bytes[s.renditions.front().video_uri] = s.renditions.front().video_bytes;
  }
}

}  // namespace

Status assemble(const Job& job, const WorkFolder& work, gpu::Device& device, ReportInput& report) {
  removeFolder(job.resultFolder());
  FOURDVT_TRY(makeFolder(job.resultFolder()));
  package::Character character = describeCharacter(job);
  for (const SequencePlan& plan : job.sequences) {
    auto packed = packSequence(job, plan, work);
    if (!packed) return packed.error();
    character.sequences.push_back(std::move(packed.value().manifest));
    report.sequences.push_back(std::move(packed.value().report));
  }
  FOURDVT_TRY(writeFile(job.resultFolder() + "/" + kMesh, job.mesh.bytes));
  FOURDVT_TRY(writeStills(job, work, device, character));
  auto manifest = package::writeManifest({character, &job.mesh, kTexture, kGenerator, job.capture.credit});
  if (!manifest) return manifest.error();
  FOURDVT_TRY(writeFile(job.resultFolder() + "/character.gltf", manifest.value()));
  describe(job, character, report);
  return {};
}

Status writeReportFiles(const Job& job, const ReportInput& report) {
  FOURDVT_TRY(writeFile(job.resultFolder() + "/report.json", reportJson(report)));
  return writeFile(job.resultFolder() + "/report.html", reportHtml(report));
}

}  // namespace fourdvt::bake
