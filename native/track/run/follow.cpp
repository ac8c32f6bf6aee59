// SPDX-License-Identifier: Apache-2.0
#include "track/run/follow.h"

#include <map>
#include <queue>
#include <tuple>

#include "base/watch.h"

namespace fourdvt::track {
namespace {

constexpr int kMaxTries = 2;  // repairs tried for a bad fit

// Each frame after its predecessor, outwards from the template's; the first of another sequence after the template.
std::vector<TrackingStep> orderInTime(const FrameList& list, uint32_t root) {
  std::vector<TrackingStep> out{{root, root, 0, 0}};
  for (uint32_t s = 0; s < list.starts.size(); ++s) {
    const uint32_t first = list.starts[s], end = s + 1 < list.starts.size() ? list.starts[s + 1] : list.count;
    const bool own = root >= first && root < end;
    const uint32_t start = own ? root : first;
    if (!own) out.push_back({start, root, 0, 1});
    for (uint32_t f = start + 1; f < end; ++f) out.push_back({f, f - 1, 0, f - start + (own ? 0 : 1)});
    for (uint32_t f = start; f-- > first;) out.push_back({f, f + 1, 0, start - f + (own ? 0 : 1)});
  }
  return out;
}

}  // namespace

Result<std::vector<TrackingStep>> orderOf(const Prepared& job, const Work& work, const ChosenTemplate& chosen) {
  if (!job.options.by_similarity) return orderInTime(work.frames(), chosen.frame);
  std::vector<FrameThumbnails> thumbnails(work.frames().count);
  for (uint32_t frame = 0; frame < thumbnails.size(); ++frame) {
    FOURDVT_ASSIGN(thumbnails[frame], work.thumbnails(frame));
  }
  return trackingOrder(thumbnails, chosen.frame);
}

Result<Follower> Follower::create(const Prepared& job, Work& work, const ChosenTemplate& chosen) {
  FOURDVT_ASSIGN(const TriangleMesh surface, surfaceOf(job, work, chosen.frame));
  Follower out(job, work, chosen,
               makeTemplate(chosen.mesh.topology, chosen.mesh.positions, job.options.nodes, surface));
  FOURDVT_ASSIGN(out.anchor_, work.pictures(chosen.frame));
  return out;
}

Result<TrackedFrame> Follower::fitted(uint32_t frame, uint32_t parent) {
  const Watch watch;
  FOURDVT_ASSIGN(const FramePictures pictures, work_.pictures(frame));
  FOURDVT_ASSIGN(const TriangleMesh surface, surfaceOf(job_, work_, frame));
  const NearestSurface nearest(surface);
  const TargetFrame target{&surface, &nearest, &pictures.views};
  const PosedViews anchor{&anchor_.views, &model_.positions};
  TrackedFrame out{restFrame(model_), {}, 0};
  if (frame != chosen_.frame) {
    const auto from = work_.tracked(parent);
    if (!from) return Error{ErrorId::Internal, work_.nameOf(frame) + ": its parent is not fitted"};
    FOURDVT_ASSIGN(const FramePictures there, work_.pictures(parent));
    FitOptions options = job_.options.fit;
    for (const bool wide : {false, true}) {
      options.wide = wide;
      FittedFrame fit = fitFrame(model_, from->fit, {&there.views, &from->fit.positions}, anchor, target, options);
      FitFigures figures = figuresOf(model_, fit, anchor, target);
      if (wide && misfit(figures) >= misfit(out.figures)) continue;
      out.fit = std::move(fit), out.figures = std::move(figures);
      if (misfit(out.figures) <= kMaxMisfit) break;
    }
  } else {
    out.figures = figuresOf(model_, out.fit, anchor, target);
  }
  out.seconds = watch.seconds();
  return out;
}

Result<bool> Follower::follow(uint32_t frame, uint32_t parent) {
  if (work_.tracked(frame)) return false;
  FOURDVT_ASSIGN(const TrackedFrame found, fitted(frame, parent));
  FOURDVT_TRY(work_.save(frame, found));
  return true;
}

Result<bool> Follower::repair(uint32_t frame, uint32_t parent) {
  FOURDVT_ASSIGN(TrackedFrame found, fitted(frame, parent));
  const auto before = work_.tracked(frame);
  if (before && misfit(before->figures) <= misfit(found.figures)) return false;
  if (before) found.seconds += before->seconds;
  work_.setRepair(frame, std::move(found));
  return true;
}

Status repairFits(Follower& follower, const Prepared& job, const Work& work, const TrackEnvironment& environment) {
  const uint32_t count = work.frames().count;
  std::vector<bool> good(count);
  std::map<uint32_t, FrameThumbnails> bad;  // frames with bad fits
  for (uint32_t f = 0; f < count; ++f) {
    FOURDVT_ASSIGN(const TrackedFrame tracked, work.requireTracked(f));
    good[f] = misfit(tracked.figures) <= kMaxMisfit;
    if (good[f]) continue;
    FOURDVT_ASSIGN(bad[f], work.thumbnails(f));
  }
  if (bad.empty()) return {};
  struct Try {
    double dissimilarity;
    uint32_t frame, parent;
    bool operator>(const Try& other) const {
      return std::tie(dissimilarity, frame, parent) > std::tie(other.dissimilarity, other.frame, other.parent);
    }
  };
  std::priority_queue<Try, std::vector<Try>, std::greater<>> open;
  const auto addParent = [&](uint32_t parent) -> Status {
    FOURDVT_ASSIGN(const FrameThumbnails there, work.thumbnails(parent));
    for (const auto& [f, thumbnails] : bad)
      if (!good[f]) open.push({dissimilarity(thumbnails, there), f, parent});
    return {};
  };
  for (uint32_t f = 0; f < count; ++f)
    if (good[f]) FOURDVT_TRY(addParent(f));
  std::vector<int> tries(count, 0);
  while (!open.empty()) {
    const Try next = open.top();
    open.pop();
    if (good[next.frame] || tries[next.frame] >= kMaxTries) continue;
    FOURDVT_TRY(stopped(job, environment));
    if (environment.progress) environment.progress({"repairing " + work.nameOf(next.frame), count, count, 0, 0});
    ++tries[next.frame];
    FOURDVT_TRY(follower.repair(next.frame, next.parent));
    const auto tracked = work.tracked(next.frame);
    good[next.frame] = tracked && misfit(tracked->figures) <= kMaxMisfit;
    if (good[next.frame]) FOURDVT_TRY(addParent(next.frame));
  }
  return {};
}

}  // namespace fourdvt::track
