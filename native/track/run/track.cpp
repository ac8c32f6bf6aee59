// SPDX-License-Identifier: Apache-2.0
#include "track/run/track.h"

#include <opencv2/core/utility.hpp>

#include "track/run/finish.h"
#include "track/run/follow.h"
#include "track/run/prepare.h"

namespace fourdvt::track {
namespace {

// Fits all frames in order. Returns the number of earlier fits that were kept.
Result<uint32_t> followAll(const Prepared& job, Work& work, const ChosenTemplate& chosen,
                           std::span<const TrackingStep> steps, const TrackEnvironment& environment) {
  FOURDVT_ASSIGN(Follower follower, Follower::create(job, work, chosen));
  const Watch watch;
  uint32_t kept = 0, done = 0;
  for (const TrackingStep& step : steps) {
    FOURDVT_TRY(stopped(job, environment));
    FOURDVT_ASSIGN(const bool made, follower.follow(step.frame, step.parent));
    kept += !made;
    ++done;
    if (!environment.progress) continue;
    FrameProgress p{"following " + work.nameOf(step.frame), done, uint32_t(steps.size()), 0, 0};
    if (done > kept) {
      p.frames_per_s = (done - kept) / watch.seconds();
      p.left_s = (p.total - done) / p.frames_per_s;
    }
    environment.progress(p);
  }
  FOURDVT_TRY(repairFits(follower, job, work, environment));
  return kept;
}

}  // namespace

Result<TrackSummary> track(const TrackOptions& options, const TrackEnvironment& environment) {
  if (options.jobs > 0) cv::setNumThreads(options.jobs);
  const Watch watch;
  FOURDVT_ASSIGN(const Prepared job,
                 prepare(options, options.resume ? capture::Earlier::Kept : capture::Earlier::Removed, environment));
  const capture::ResultFolder folder = resultFolder(job.options);
  Work work(folder, job.capture, job.settings_key);
  FOURDVT_TRY(storePictures(job, work, environment));
  FOURDVT_ASSIGN(const ChosenTemplate chosen, makeTemplateOf(job, work, environment));
  FOURDVT_ASSIGN(const auto steps, orderOf(job, work, chosen));
  FOURDVT_ASSIGN(const uint32_t kept, followAll(job, work, chosen, steps, environment));
  FOURDVT_ASSIGN(TrackSummary summary, writeResult(job, work, chosen, steps, folder.partFolder()));
  summary.frames_kept = kept;
  summary.wall_s = watch.seconds();
  FOURDVT_TRY(folder.finish());
  return summary;
}

}  // namespace fourdvt::track
