// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/finish.h"

#include "base/text.h"
#include "mattes/frame_reader.h"

namespace fourdvt::reconstruct {

Status drawKept(const Prepared& job, const FrameStore& store, const capture::CaptureSequence& sequence, uint32_t frame,
                const OpenVideo& open_video, ReportPictures& pictures) {
  FOURDVT_ASSIGN(const auto reader, mattes::FrameReader::open(job.capture, sequence, open_video, frame));
  FOURDVT_ASSIGN(const auto captured, reader->next());
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : job.capture.cameras) cameras.push_back(camera.pinhole);
  FrameSurface surface;
  FOURDVT_ASSIGN(surface.mesh, store.loadMesh(sequence.name, frame));
  surface.silhouettes = silhouettesOf(cameras, captured.pictures);
  pictures.add(sequence.name, frame, captured.pictures, surface);
  return {};
}

Result<ReconstructSummary> writeResult(const Prepared& job, const FrameStore& store, const ReportPictures& pictures,
                                       const std::optional<RunTime>& run) {
  std::vector<ReconstructedSequence> done;
  double frames_s = 0;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    ReconstructedSequence& out = done.emplace_back();
    out.name = sequence.name;
    for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
      auto figures = store.find(sequence.name, frame);
      if (!figures)
        return Error{ErrorId::InvalidArgument, job.folderOf(sequence.name) + ", frame " + std::to_string(frame) +
                                                   ": is missing among the finished frames; run `fourdvt plan` again, "
                                                   "or `fourdvt reconstruct --resume`"};
      frames_s += figures->seconds();
      out.frames.push_back(std::move(*figures));
    }
    store.removeLeftovers(sequence.name);
  }
  ReconstructSummary summary = summarise(job.capture, done);
  summary.frames_kept = run ? run->frames_kept : 0;
  summary.warnings.insert(summary.warnings.begin(), job.warnings.begin(), job.warnings.end());
  summary.warnings = joinedWarnings(summary.warnings);
  summary.wall_s = run ? run->wall_s : frames_s;
  FOURDVT_TRY(writeReport(resultFolder(job.options).partFolder(), job.options, job.capture, done, pictures, summary));
  return summary;
}

}  // namespace fourdvt::reconstruct
