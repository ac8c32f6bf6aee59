// SPDX-License-Identifier: Apache-2.0
#include "refine/silhouettes/rig_fit.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/robust.h"

namespace fourdvt::refine {
namespace {

constexpr size_t kFrames = 12, kPoints = 60;  // per clip; per picture
constexpr size_t kMaxRounds = 8;              // changes per camera, on average
constexpr size_t kSeveral = 3;                // cameras
constexpr int kPlaceRounds = 50;
constexpr double kMinTurn_rad = 1e-5;

std::vector<BlockedPoint> pointsOf(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& cameras,
                                   const std::vector<char>& ignored, size_t camera, float reach_pixels) {
  std::vector<BlockedPoint> out;
  for (const TimedClip& timed : clips) {
    const RigState rig{cameras, timed.offset_frames, ignored};
    const auto more = hullPoints(*timed.clip, rig, camera, timed.clip->spreadFrames(kFrames), kPoints, 0, reach_pixels);
    out.insert(out.end(), more.begin(), more.end());
  }
  return out;
}

class Rig {
 public:
  Rig(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& given, const std::vector<char>& ignored,
      const std::function<bool()>& go_on)
      : clips_(clips), given_(given), ignored_(ignored), go_on_(go_on), now_(given), out_(given.size()) {
    for (size_t c = 0; c < given.size(); ++c) out_[c].camera = given[c];
  }

  // Changes cameras until no change is significant. If several changed, each was compared with hulls that contained the
  // others' errors: repeats with a lower threshold.
  std::vector<CameraRefit> fit() {
    settle(kClearDeviations);
    size_t moved = 0;
    for (size_t c = 0; c < given_.size(); ++c) moved += now_[c].cam_from_world != given_[c].cam_from_world;
    if (moved >= kSeveral) settle(1);
    return settled();
  }

 private:
  // Sweeps over the cameras that may still change; applies the change with the largest gain.
  void settle(double deviations) {
    const size_t cameras = given_.size();
    std::vector<char> asked(cameras, 1);
    bool everyone = true;
    for (size_t round = 0; round < kMaxRounds * cameras && go_on_(); ++round) {
      const int best = sweep(asked, deviations);
      if (best < 0 && everyone) break;
      everyone = best < 0;
      if (everyone)
        std::fill(asked.begin(), asked.end(), 1);
      else
        now_[best] = out_[best].camera;
    }
  }

  // Refits the marked cameras, unmarks unchanged ones, and returns the one with the largest gain, or -1.
  int sweep(std::vector<char>& asked, double deviations) {
    std::vector<CameraRefit> tried(given_.size());
    inParallel(given_.size(), [&](int c) {
      if (!asked[c] || (c < int(ignored_.size()) && ignored_[c])) return;
      const auto measure = [&](const PinholeCamera& as, float reach) {
        std::vector<PinholeCamera> cameras = now_;
        cameras[c] = as;
        return pointsOf(clips_, cameras, ignored_, c, reach);
      };
      tried[c] = refitCamera(now_[c], given_[c], measure, false, SurfaceKind::Hull, deviations);
    });
    int best = -1;
    double most = 0;
    for (size_t c = 0; c < given_.size(); ++c) {
      if (!asked[c]) continue;
      asked[c] = tried[c].changed;
      if (tried[c].best) out_[c] = tried[c];
      const double gain = tried[c].spread_before_pixels - tried[c].spread_after_pixels;
      if (tried[c].changed && (best < 0 || gain > most)) best = int(c), most = gain;
    }
    return best;
  }

  std::vector<CameraRefit> settled() const {
    std::vector<CameraRefit> out = out_;
    for (size_t c = 0; c < given_.size(); ++c) {
      out[c].camera = now_[c];
      out[c].changed = now_[c].cam_from_world != given_[c].cam_from_world;
    }
    return out;
  }

  const std::vector<TimedClip>& clips_;
  const std::vector<PinholeCamera>& given_;
  const std::vector<char>& ignored_;
  const std::function<bool()>& go_on_;
  std::vector<PinholeCamera> now_;
  std::vector<CameraRefit> out_;
};

}  // namespace

std::vector<CameraRefit> fitRig(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& given,
                                const std::vector<char>& ignored, const std::function<bool()>& go_on) {
  return Rig(clips, given, ignored, go_on).fit();
}

std::vector<PinholeCamera> minTurned(const std::vector<PinholeCamera>& given, const std::vector<PinholeCamera>& found,
                                     const glm::dvec3& middle_in_world, const std::vector<double>& near_deg) {
  const size_t cameras = given.size();
  // A shift `at` of the performer corresponds to rotations by_place[c] · at of camera c, radians.
  std::vector<glm::dvec3> turn(cameras);
  std::vector<glm::dmat3> by_place(cameras);
  for (size_t c = 0; c < cameras; ++c) {
    const glm::dmat3 r = glm::dmat3(found[c].cam_from_world) * glm::transpose(glm::dmat3(given[c].cam_from_world));
    turn[c] = 0.5 * glm::dvec3(r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]);
    const glm::dvec3 p(given[c].cam_from_world * glm::dvec4(middle_in_world, 1));
    const glm::dmat3 cross(0, p.z, -p.y, -p.z, 0, p.x, p.y, -p.x, 0);  // cross product of p with a vector
    by_place[c] = cross * glm::dmat3(given[c].cam_from_world) / glm::dot(p, p);
  }
  glm::dvec3 at(0);
  for (int round = 0; round < kPlaceRounds; ++round) {  // least absolute deviations, by reweighting
    glm::dmat3 left(1e-9);
    glm::dvec3 right(0);
    for (size_t c = 0; c < cameras; ++c) {
      const double weight = 1 / std::max(kMinTurn_rad, glm::length(turn[c] - by_place[c] * at));
      left += weight * glm::transpose(by_place[c]) * by_place[c];
      right += weight * glm::transpose(by_place[c]) * turn[c];
    }
    at = glm::inverse(left) * right;
  }
  std::vector<PinholeCamera> out;
  for (size_t c = 0; c < cameras; ++c) {
    const glm::dvec3 rest = turn[c] - by_place[c] * at;
    const bool near = kDegrees * glm::length(rest) <= near_deg[c];
    out.push_back(near ? given[c] : changed(given[c], {.turn_rad = rest}));
  }
  return out;
}

std::vector<StickOut> stickOut(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& cameras,
                               const std::vector<char>& ignored) {
  std::vector<StickOut> out(cameras.size());
  inParallel(cameras.size(), [&](int c) {
    for (const TimedClip& timed : clips) {
      const StickOut of_clip =
          stickOut(*timed.clip, {cameras, timed.offset_frames, ignored}, size_t(c), kFrames, kPoints, 0);
      const auto points = double(of_clip.points);
      out[c].points += of_clip.points;
      out[c].mean_pixels += points * of_clip.mean_pixels, out[c].far_share += points * of_clip.far_share;
    }
    const auto points = double(std::max<size_t>(1, out[c].points));
    out[c].mean_pixels /= points, out[c].far_share /= points;
  });
  return out;
}

}  // namespace fourdvt::refine
