// SPDX-License-Identifier: Apache-2.0
#include "bake/run/stream_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "bake/run/content_names.h"
#include "base/hash.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

std::string ffmpegVersion(unsigned v) {
  return std::to_string(v >> 16) + "." + std::to_string((v >> 8) & 255) + "." + std::to_string(v & 255);
}

// Offsets are counted from behind the header, whose size they must not change.
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
    auto chunk = work.loadChunk(plan.name, c % gops, c < gops ? Precision::Fine : Precision::Coarse);
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
Result<Mp4Samples> packVideo(const StreamPlan& plan, size_t rendition, const WorkFolder& work,
                             const std::string& path) {
  const EncodeSettings& settings = plan.renditions[rendition].encode;
  FOURDVT_TRY(writeMp4(path, settings, static_cast<uint32_t>(plan.gop_first_frames.size()),
                       [&](uint32_t g) -> Result<EncodedGop> {
                         FOURDVT_ASSIGN(auto artefact, work.loadGop(plan.name, g));
                         if (rendition >= artefact.videos.size())
                           return Error{ErrorId::Internal, path + ": a GOP lacks this rendition; bake again"};
                         return std::move(artefact.videos[rendition]);
                       }));
  FOURDVT_ASSIGN(auto packed, readMp4Samples(path, settings.fps, plan.gop_first_frames, plan.frameCount()));
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
  for (size_t r = plan.renditions.size(); r-- > 0;) {  // of equal size, the highest comes last
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
