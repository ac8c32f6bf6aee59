// SPDX-License-Identifier: Apache-2.0
#include "track/run/pieces.h"

#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "capture/folder/archive.h"
#include "capture/input_files.h"
#include "jobs/job_file.h"
#include "platform/files.h"
#include "track/frame_paths.h"
#include "track/run/finish.h"
#include "track/run/follow.h"
#include "track/run/prepare.h"

namespace fourdvt::track {

// State from which every piece continues.
struct TrackJob {
  Prepared prepared;
  std::vector<TrackingStep> steps;
  uint64_t common_input_digest = 0;     // see capture/input_files.h
  std::vector<uint64_t> frame_digests;  // [frame] its pictures and surface
};

}  // namespace fourdvt::track

namespace fourdvt::store {

void fields(Archive& a, track::FrameName& n) { a(n.sequence, n.frame); }
// Options that determine the result.
void fields(Archive& a, track::TrackOptions& o) {
  a(o.capture_folder, o.folder, o.sequences, o.template_frame, o.mesh, o.nodes, o.loops, o.classes, o.fit,
    o.by_similarity);
}
void fields(Archive& a, track::TrackJob& j) {
  a(j.prepared.options, j.prepared.capture, j.prepared.settings_key, j.steps, j.common_input_digest, j.frame_digests);
}

}  // namespace fourdvt::store

namespace fourdvt::track {
namespace {

constexpr size_t kMaxFrames = 8;  // frames of a piece
constexpr const char* kFitsPiece = "fits";

uint64_t digestOf(const capture::Capture& capture, const FrameList& list, uint32_t frame) {
  const uint32_t s = list.sequenceOf(frame), f = frame - list.starts[s];
  return capture::inputDigest(capture, capture.sequences[s], f, f + 1);
}

std::string idOf(const FramePath& path, const TrackJob& job, const FrameList& list) {
  const uint32_t first = path.frames[0], s = list.sequenceOf(first);
  return std::string(kFitsPiece) + "-" + job.prepared.capture.sequences[s].name + "-" +
         std::to_string(first - list.starts[s]);
}

jobs::Piece pieceOf(const char* kind, std::string id, const TrackJob& job) {
  jobs::Piece out;
  out.kind = kind, out.id = std::move(id), out.inputs = job.common_input_digest;
  return out;
}

// Resource estimates for schedulers, measured on two cores: a twentieth of the frames is repaired, with two tries.
// Memory is at least 1.5 times the measured one.
class Costs {
 public:
  // `views`: pictures of the template's frame.
  Costs(const Prepared& job, const std::vector<View>& views) : kilofaces_(job.options.mesh.faces / 1e3) {
    for (const View& view : views) megapixels_ += double(view.grey.total()) / 1e6;
  }
  double start_s() const { return 1; }
  double frame_s() const { return 1 + 0.8 * megapixels_; }
  double memory_mb() const { return 300 + 40 * megapixels_ + 4 * kilofaces_; }
  double finish_s(uint32_t frames) const { return (0.02 + 0.1 * frame_s()) * frames; }
  double finish_mb(uint32_t frames) const { return memory_mb() + 0.02 * kilofaces_ * frames; }

 private:
  double megapixels_ = 0, kilofaces_;  // sum over the cropped pictures of all cameras; template
};

std::vector<jobs::Piece> piecesOf(const TrackJob& job, const FrameList& list, std::span<const FramePath> paths,
                                  const Costs& costs) {
  std::vector<jobs::Piece> out;
  std::vector<std::string> ids(list.count);  // [frame] its piece
  for (const FramePath& path : paths) {
    jobs::Piece& piece = out.emplace_back(pieceOf(kFitsPiece, idOf(path, job, list), job));
    piece.addInput(job.frame_digests[job.steps[0].frame]);
    for (const uint32_t frame : path.frames) {
      piece.addInput(job.frame_digests[frame]);
      ids[frame] = piece.id;
    }
    if (ids[path.parent] != piece.id) piece.needs = {ids[path.parent]};
    piece.setCost(costs.start_s() + costs.frame_s() * double(path.frames.size()), costs.memory_mb());
  }
  jobs::Piece finish = pieceOf(jobs::kFinish, jobs::kFinish, job);
  for (const jobs::Piece& piece : out) finish.needs.push_back(piece.id);
  finish.setCost(costs.start_s() + costs.finish_s(list.count), costs.finish_mb(list.count));
  out.push_back(std::move(finish));
  return out;
}

Status checkFiles(const TrackJob& job, const FrameList& list, uint32_t frame) {
  const capture::Capture& capture = job.prepared.capture;
  if (digestOf(capture, list, frame) == job.frame_digests[frame]) return {};
  const uint32_t s = list.sequenceOf(frame);
  return jobs::changedSincePlan(capture.sequences[s].folder + ": files of frame " +
                                std::to_string(frame - list.starts[s]));
}

Status checkCommon(const TrackJob& job) {
  const capture::Capture& capture = job.prepared.capture;
  if (capture::commonInputDigest(capture) == job.common_input_digest) return {};
  return jobs::changedSincePlan(capture.folder + ": capture.json, cameras or plates");
}

Result<ChosenTemplate> plannedTemplate(const std::string& job_folder, const Work& work) {
  if (auto found = work.chosenTemplate()) return std::move(*found);
  return Error{ErrorId::FileMissing, job_folder + ": its template is missing or damaged; run `fourdvt plan` again"};
}

}  // namespace

Result<jobs::Plan> planTrack(const TrackOptions& options, std::vector<std::string> arguments,
                             const TrackEnvironment& environment) {
  if (options.jobs > 0) cv::setNumThreads(options.jobs);
  TrackJob job;
  FOURDVT_ASSIGN(job.prepared, prepare(options, capture::Earlier::KeptIfSame, environment));
  const Prepared& prepared = job.prepared;
  const capture::Capture& capture = prepared.capture;
  FOURDVT_TRY(jobs::checkSequenceNames(prepared.options.sequences, prepared.options.capture_folder, "track"));
  const capture::ResultFolder folder = resultFolder(prepared.options);
  const Work work(folder, capture, prepared.settings_key);
  FOURDVT_TRY(storePictures(prepared, work, environment));
  FOURDVT_ASSIGN(const ChosenTemplate chosen, makeTemplateOf(prepared, work, environment));
  FOURDVT_ASSIGN(job.steps, orderOf(prepared, work, chosen));
  const FrameList& list = work.frames();
  job.common_input_digest = capture::commonInputDigest(capture);
  for (uint32_t frame = 0; frame < list.count; ++frame) job.frame_digests.push_back(digestOf(capture, list, frame));
  const auto paths = framePaths(job.steps, kMaxFrames);
  FOURDVT_ASSIGN(const FramePictures pictures, work.pictures(chosen.frame));
  jobs::Plan plan{.command = "track",
                  .arguments = std::move(arguments),
                  .capture = prepared.options.capture_folder,
                  .result = prepared.options.folder,
                  .frames = list.count,
                  .capture_s = list.count / capture.fps,
                  .pieces = piecesOf(job, list, paths, Costs(prepared, pictures.views))};
  FOURDVT_TRY(jobs::settleHashes(prepared.settings_key, plan));
  FOURDVT_TRY(jobs::writeJobFile(folder.workFolder(), job));
  jobs::dropRecords(folder.workFolder(), plan, [&](size_t p) {
    return !std::all_of(paths[p].frames.begin(), paths[p].frames.end(), [&](uint32_t f) { return work.tracked(f); });
  });
  FOURDVT_TRY(jobs::writePlan(folder.workFolder(), plan));
  return plan;
}

Status trackPiece(const std::string& job_folder, const jobs::Piece& piece, int threads,
                  const TrackEnvironment& environment) {
  cv::setNumThreads(threads);
  FOURDVT_ASSIGN(const TrackJob job, jobs::readJobFile<TrackJob>(job_folder));
  const Prepared& prepared = job.prepared;
  Work work(resultFolder(prepared.options), prepared.capture, prepared.settings_key);
  const FrameList& list = work.frames();
  const auto paths = framePaths(job.steps, kMaxFrames);
  const auto path =
      std::find_if(paths.begin(), paths.end(), [&](const FramePath& p) { return idOf(p, job, list) == piece.id; });
  if (path == paths.end())
    return Error{ErrorId::InvalidArgument, job_folder + ": piece " + piece.id + " makes no fits"};
  FOURDVT_TRY(checkCommon(job));
  FOURDVT_ASSIGN(const ChosenTemplate chosen, plannedTemplate(job_folder, work));
  FOURDVT_TRY(checkFiles(job, list, chosen.frame));
  for (const uint32_t frame : path->frames) FOURDVT_TRY(checkFiles(job, list, frame));
  uint32_t parent = path->parent, done = 0;
  if (parent != path->frames[0]) {
    if (const auto fitted = work.requireTracked(parent); !fitted.ok()) return fitted.error();
  }
  FOURDVT_ASSIGN(Follower follower, Follower::create(prepared, work, chosen));
  for (const uint32_t frame : path->frames) {
    FOURDVT_TRY(stopped(prepared, environment));
    FOURDVT_TRY(follower.follow(frame, parent));
    parent = frame;
    if (environment.progress) environment.progress({work.nameOf(frame), ++done, uint32_t(path->frames.size()), 0, 0});
  }
  return {};
}

Result<TrackSummary> finishTrack(const std::string& job_folder, const TrackEnvironment& environment) {
  FOURDVT_ASSIGN(const TrackJob job, jobs::readJobFile<TrackJob>(job_folder));
  const Prepared& prepared = job.prepared;
  FOURDVT_TRY(checkCommon(job));
  const capture::ResultFolder folder = resultFolder(prepared.options), own = folder.ofThisProcess();
  Work work(folder, prepared.capture, prepared.settings_key);
  FOURDVT_ASSIGN(const ChosenTemplate chosen, plannedTemplate(job_folder, work));
  FOURDVT_ASSIGN(Follower follower, Follower::create(prepared, work, chosen));
  FOURDVT_TRY(repairFits(follower, prepared, work, environment));
  FOURDVT_TRY(platform::makeFolder(own.partFolder()));
  auto summary = writeResult(prepared, work, chosen, job.steps, own.partFolder());
  const Status placed = summary.ok() ? own.place() : Status(summary.error());
  platform::removeFolder(own.partFolder());
  platform::removeIfEmpty(folder.partFolder());
  FOURDVT_TRY(placed);
  return summary;
}

}  // namespace fourdvt::track
