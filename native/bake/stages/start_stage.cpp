// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/start_stage.h"

#include "base/hash.h"
#include "package/start_file.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

// The first picture waits for every byte of the start file; what comes after it is a round trip sooner with them.
constexpr size_t kMostHeaderBytes = 4096;

}  // namespace

Status writeStart(const BakeRun& run, package::Character& character, ReportInput& report) {
  const Job& job = run.job;
  const std::string folder = job.resultFolder() + "/";
  const package::Sequence& s = character.sequences[0];
  FOURDVT_ASSIGN(const auto header, platform::readFileRange(folder + s.stream_uri, 0, s.stream_header_bytes));
  FOURDVT_ASSIGN(auto index, package::readStreamHeader(header));
  const bool coarse = s.hasCoarseGeometry(0);
  FOURDVT_ASSIGN(const auto gop, run.work.load<store::Bytes>(
                                     chunkFile(job.streams[0].name, 0, coarse ? Precision::Coarse : Precision::Fine)));
  const package::VideoSample key = index.renditions[0].samples[0];
  if (coarse) index.position_step_m = index.coarse_step_m;
  FOURDVT_ASSIGN(const auto video, platform::readFileRange(folder + s.renditions[0].video_uri, key.offset, key.bytes));
  const auto follows = std::span(header).first(header.size() <= kMostHeaderBytes ? header.size() : 0);
  FOURDVT_ASSIGN(const auto file, job.fromCameras()
                                      ? package::encodeStartFile(index, gop, video, follows, character, s)
                                      : package::encodeStartFile(index, gop, video, follows, job.mesh.decoded));
  character.start = {kStartFile, file.size(), fnv1a(file)};
  report.figures.bytes_by_part[kStartFile] = file.size();
  return platform::writeFileAtomic(folder + kStartFile, file);
}

}  // namespace fourdvt::bake
