// SPDX-License-Identifier: Apache-2.0
#include "refine/silhouettes/calibration.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "base/text.h"
#include "capture/matted_pictures.h"
#include "mattes/frame_reader.h"
#include "refine/outline.h"

namespace fourdvt::refine {
namespace {

constexpr uint32_t kMaxFrames = 48, kMinFramesPerSequence = 8;  // per sequence
constexpr uint32_t kMaxKeyedFrames = 16;                        // limit if mattes have to be computed
constexpr size_t kMaxClips = 4;                                 // sequences used for poses
constexpr int kRounds = 3;                                      // alternations of times and cameras
// Minimum change of a time; it must exceed kDeviations standard deviations, too.
constexpr double kMinOffsetFrames = 0.1, kDeviations = 3;
// Times and poses are accepted if the outline error falls below this share of the previous one, and the previous one
// exceeded the mattes' own error.
constexpr double kClearGain = 0.7, kConsistentPixels = 0.1;
constexpr double kMaxNear_deg = 0.1, kAsGood = 1.2;  // cameras that stay as given, see keepAsGiven
constexpr double kFarShare = 0.1;                    // share of a camera's outline; above, the camera is inconsistent
constexpr size_t kDrawnPoints = 2000;                // outline points in the report's picture
constexpr float kDrawnReachPixels = 30;
constexpr double kCulprit = 0.5;  // without the culprit, the others' error falls below this share

Error interrupted() { return {ErrorId::Interrupted, "stopped; nothing was saved, run the same command again"}; }

// True if mattes of some camera have to be computed.
Result<bool> keyed(const capture::Capture& capture, const OpenVideo& open_video) {
  for (const capture::CaptureSequence& sequence : capture.sequences)
    for (const capture::CaptureCamera& camera : capture.cameras) {
      FOURDVT_ASSIGN(const auto origin, capture::matteOrigin(sequence, camera, open_video));
      if (origin == capture::MatteOrigin::None) return true;
    }
  return false;
}

class Calibrator {
 public:
  using Progress = std::function<bool(const std::string&, double)>;
  Calibrator(const capture::Capture& capture, const CalibrationOptions& options, const Progress& progress)
      : capture_(capture), options_(options), progress_(progress) {}

  Result<Calibration> run(const OpenVideo& open_video) {
    if (capture_.cameras.size() < 3)
      return Error{ErrorId::InvalidArgument,
                   capture_.folder + ": silhouettes of fewer than three cameras say nothing about their calibration"};
    FOURDVT_TRY(read(open_video));
    const auto before = stickOut(timed(), now_, {});
    for (int round = 0; round < kRounds; ++round) {
      if (options_.times) fitAllTimes(round);
      if (!go_on("cameras", 0.5 + 0.1 * round)) return interrupted();
      const bool moved = options_.cameras && fitCameras();
      if (stopped_) return interrupted();
      if (!moved || !options_.times) break;
    }
    findUnexplained();
    if (stopped_) return interrupted();
    Calibration out = told(before);
    if (out.changed()) FOURDVT_TRY(drawWorst(open_video, out));
    return out;
  }

 private:
  bool go_on(const std::string& what, double share) {
    stopped_ = stopped_ || !progress_(what, share);
    return !stopped_;
  }

  Status read(const OpenVideo& open_video) {
    const size_t sequences =
        std::min(capture_.sequences.size(), options_.times ? capture_.sequences.size() : kMaxClips);
    FOURDVT_ASSIGN(const bool keys, keyed(capture_, open_video));
    const uint32_t most = keys ? kMaxKeyedFrames : kMaxFrames;
    const auto frames = uint32_t(std::max<size_t>(kMinFramesPerSequence, 2 * most / (1 + sequences)));
    for (size_t s = 0; s < sequences; ++s) {
      const capture::CaptureSequence& sequence = capture_.sequences[s];
      FOURDVT_ASSIGN(auto clip,
                     readSilhouetteClip(capture_, sequence, open_video, frames, sequences, [&](double share) {
                       return go_on("silhouettes of " + sequence.name, 0.3 * (double(s) + share) / double(sequences));
                     }));
      out_.frames += uint32_t(clip.frames());
      clips_.push_back(std::move(clip));
      offsets_.emplace_back(capture_.cameras.size(), 0.0);
    }
    given_ = now_ = clips_.front().cameras();
    times_.resize(clips_.size());
    refits_.resize(given_.size());
    ignored_.assign(given_.size(), 0);
    for (size_t c = 0; c < given_.size(); ++c) refits_[c].camera = given_[c];
    return {};
  }

  std::vector<TimedClip> timed() const {
    std::vector<TimedClip> out;
    for (size_t s = 0; s < clips_.size(); ++s) out.push_back({&clips_[s], offsets_[s]});
    return out;
  }

  void fitAllTimes(int round) {
    for (size_t s = 0; s < clips_.size(); ++s) {
      const double share = double(s) / double(clips_.size());
      if (!go_on("times of " + capture_.sequences[s].name, 0.3 + 0.2 * share)) return;
      times_[s] = fitTimes(clips_[s], {now_, offsets_[s], ignored_}, {round == 0 ? options_.max_frames : 0});
      std::vector<double> offsets(given_.size(), 0.0);
      for (size_t c = 0; c < given_.size(); ++c) {
        const CameraTime& time = times_[s][c];
        const bool clear = time.known && std::abs(time.offset_frames) >=
                                             std::max(kMinOffsetFrames, kDeviations * time.deviation_frames);
        if (clear) offsets[c] = time.offset_frames;
      }
      if (!explainsMore(clips_[s], offsets)) std::fill(offsets.begin(), offsets.end(), 0.0);
      offsets_[s] = std::move(offsets);
    }
  }

  // Mean over all points of all cameras, pixels of the reduced pictures.
  double outside(const std::vector<TimedClip>& clips, const std::vector<PinholeCamera>& cameras) const {
    double sum = 0, points = 0;
    for (const StickOut& s : stickOut(clips, cameras, ignored_))
      sum += s.mean_pixels * double(s.points), points += double(s.points);
    return points > 0 ? sum / points : 0;
  }

  // True if these times reduce the outline error significantly. Where it is small from the start, as with few cameras,
  // a fit only follows the hull's slack.
  bool explainsMore(const SilhouetteClip& clip, const std::vector<double>& offset_frames) const {
    const double given = outside({{&clip, std::vector<double>(offset_frames.size(), 0.0)}}, now_);
    return given > kConsistentPixels && outside({{&clip, offset_frames}}, now_) < kClearGain * given;
  }

  // Returns true if a camera changed. Changes are accepted by the same criteria.
  bool fitCameras() {
    const double given = outside(timed(), given_);
    now_ = given_;
    if (given <= kConsistentPixels) return false;
    refits_ = fitRig(timed(), given_, ignored_, [&] { return go_on("cameras", 0.6); });
    std::vector<PinholeCamera> cameras;
    for (const CameraRefit& refit : refits_) cameras.push_back(refit.camera);
    if (!(outside(timed(), cameras) < kClearGain * given)) cameras = given_;
    keepAsGiven(cameras);
    now_ = cameras;
    bool moved = false;
    for (size_t c = 0; c < cameras.size(); ++c) {
      refits_[c].camera = cameras[c];
      refits_[c].changed = cameras[c].cam_from_world != given_[c].cam_from_world;
      moved |= refits_[c].changed;
    }
    return moved;
  }

  // Selects the rig with the minimum rotation among those that fit equally well.
  void keepAsGiven(std::vector<PinholeCamera>& cameras) {
    const SilhouetteClip& clip = clips_.front();
    const double instant = double(clip.frames() / 2);
    const Extent extent = extentOf(clip, {cameras, offsets_.front(), ignored_}, instant);
    if (!extent.known) return;
    std::vector<double> near_deg;
    for (const CameraRefit& refit : refits_)
      near_deg.push_back(std::min(kMaxNear_deg, kDeviations * glm::length(refit.turn_deviation_deg)));
    const auto fewer = minTurned(given_, cameras, extent.middle_in_world, near_deg);
    if (outside(timed(), fewer) <= std::max(kConsistentPixels, kAsGood * outside(timed(), cameras))) cameras = fewer;
  }

  // Camera without which the others are consistent, if they are inconsistent with it.
  std::optional<size_t> culprit() const {
    const auto all = stickOut(timed(), now_, ignored_);
    const auto worst = std::max_element(all.begin(), all.end(),
                                        [](const StickOut& a, const StickOut& b) { return a.far_share < b.far_share; });
    if (worst->far_share < kFarShare) return std::nullopt;
    std::optional<size_t> best;
    double least = 1e9;
    for (size_t b = 0; b < all.size(); ++b) {
      if (ignored_[b]) continue;
      std::vector<char> without = ignored_;
      without[b] = 1;
      const auto others = stickOut(timed(), now_, without);
      double sum = 0, sum_with = 0;
      for (size_t c = 0; c < all.size(); ++c)
        if (!without[c]) sum += others[c].far_share, sum_with += all[c].far_share;
      if (sum < kCulprit * sum_with && sum < least) best = b, least = sum;
    }
    return best;
  }

  // Excludes inconsistent cameras from the comparison and refits the others.
  void findUnexplained() {
    for (size_t most = (given_.size() - 1) / 3; most > 0; --most) {
      if (!go_on("agreement", 0.9)) return;
      const auto bad = culprit();
      if (!bad) return;
      ignored_[*bad] = 1;
      now_ = given_;
      if (options_.times) fitAllTimes(0);
      if (options_.cameras) fitCameras();
      now_[*bad] = given_[*bad];
    }
  }

  Calibration told(const std::vector<StickOut>& before) {
    for (size_t s = 0; s < clips_.size(); ++s) out_.sequences.push_back(capture_.sequences[s].name);
    const auto after = stickOut(timed(), now_, ignored_);
    for (size_t c = 0; c < given_.size(); ++c) {
      const PinholeCamera& full = capture_.cameras[c].pinhole;
      const double scale = full.fx / given_[c].fx;
      PinholeCamera camera = full;
      camera.cam_from_world = now_[c].cam_from_world;
      const glm::dmat3 turn = glm::dmat3(camera.cam_from_world) * glm::transpose(glm::dmat3(full.cam_from_world));
      CameraCalibration told{.name = full.name};
      for (size_t s = 0; s < clips_.size(); ++s) {
        told.times.push_back(times_[s].empty() ? CameraTime() : times_[s][c]);
        told.time_changed.push_back(offsets_[s][c] != 0);
      }
      told.turned = now_[c].cam_from_world != given_[c].cam_from_world;
      told.turn_deg =
          kDegrees * 0.5 * glm::dvec3(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0]);
      told.turn_deviation_deg = refits_[c].turn_deviation_deg;
      if (refits_[c].best)
        told.shift = CameraShift{scale * refits_[c].best->pixels, scale * refits_[c].best->deviation_pixels};
      told.before = before[c], told.after = after[c];
      told.before.mean_pixels *= scale, told.after.mean_pixels *= scale;
      told.unexplained = ignored_[c] != 0;
      out_.by_camera.push_back(told);
      out_.cameras.push_back(camera);
    }
    warn();
    return std::move(out_);
  }

  Status drawWorst(const OpenVideo& open_video, Calibration& out) const {
    const auto worst = std::max_element(out.by_camera.begin(), out.by_camera.end(),
                                        [](const CameraCalibration& a, const CameraCalibration& b) {
                                          return a.before.mean_pixels < b.before.mean_pixels;
                                        });
    const auto c = size_t(worst - out.by_camera.begin());
    const SilhouetteClip& clip = clips_.front();
    const size_t frame = clip.frames() / 2;
    capture::Capture alone = capture_;
    alone.cameras = {capture_.cameras[c]};
    const capture::CaptureSequence& sequence = alone.sequences.front();
    CalibrationPicture picture{worst->name, sequence.name, clip.first_frame + uint32_t(frame), {}, {}};
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(alone, sequence, open_video, picture.frame));
    FOURDVT_ASSIGN(const auto captured, reader->next());
    const auto draw = [&](const PinholeCamera& camera, const RigState& rig) {
      std::vector<OutlinePoint> points;
      for (const BlockedPoint& p : hullPoints(clip, rig, c, {frame}, kDrawnPoints, 0, kDrawnReachPixels))
        points.push_back(p.point);
      return outlinePicture(captured.pictures[0], camera, points);
    };
    picture.before = draw(capture_.cameras[c].pinhole, {given_, std::vector<double>(given_.size(), 0.0), {}});
    picture.after = draw(out.cameras[c], {now_, offsets_.front(), ignored_});
    out.worst = std::move(picture);
    return {};
  }

  void warn() {
    for (const CameraCalibration& camera : out_.by_camera) {
      if (camera.unexplained) {
        out_.warnings.push_back(
            printed("no pose and no time of camera \"%s\" explains its silhouettes: %.0f %% of their outlines lie "
                    "more than 2 pixels outside of what the other cameras allow; check its mattes, or leave it out "
                    "(--leave-out %s)",
                    camera.name.c_str(), 100 * camera.after.far_share, camera.name.c_str()));
      }
      for (size_t s = 0; s < out_.sequences.size() && options_.times; ++s) {
        const CameraTime& time = camera.times[s];
        if (time.known && std::abs(time.offset_frames) > options_.max_frames - 0.5) {
          out_.warnings.push_back(
              printed("%s, camera \"%s\" (%.1f frames): is off by that or more, the most that is searched; search "
                      "further (--most-offset)",
                      out_.sequences[s].c_str(), camera.name.c_str(), time.offset_frames));
        }
      }
    }
    const auto worst = std::max_element(out_.by_camera.begin(), out_.by_camera.end(), [](const auto& a, const auto& b) {
      return (a.unexplained ? 0 : a.after.far_share) < (b.unexplained ? 0 : b.after.far_share);
    });
    if (!worst->unexplained && worst->after.far_share > kFarShare) {
      out_.warnings.push_back(printed(
          "the silhouettes do not fit together: %.0f %% of the outlines of camera \"%s\" lie more than 2 pixels "
          "outside of what the other cameras allow, and no single camera explains it; check mattes, "
          "calibration and synchronisation",
          100 * worst->after.far_share, worst->name.c_str()));
    }
    const auto still = [&](size_t s) {
      return std::none_of(out_.by_camera.begin(), out_.by_camera.end(),
                          [&](const CameraCalibration& c) { return c.times[s].known; });
    };
    for (size_t s = 0; s < out_.sequences.size() && options_.times; ++s)
      if (still(s))
        out_.warnings.push_back(out_.sequences[s] +
                                ": too little moves to compare the cameras' times; they stay as given");
    out_.warnings = joinedWarnings(out_.warnings);
  }

  const capture::Capture& capture_;
  const CalibrationOptions& options_;
  const Progress& progress_;
  bool stopped_ = false;
  std::vector<SilhouetteClip> clips_;           // [sequence]
  std::vector<std::vector<double>> offsets_;    // [sequence][camera] current
  std::vector<std::vector<CameraTime>> times_;  // [sequence][camera] measured
  std::vector<PinholeCamera> given_, now_;      // reduced pictures
  std::vector<CameraRefit> refits_;
  std::vector<char> ignored_;
  Calibration out_;
};

}  // namespace

bool Calibration::changed() const {
  return std::any_of(by_camera.begin(), by_camera.end(), [](const CameraCalibration& c) {
    return c.turned || std::any_of(c.time_changed.begin(), c.time_changed.end(), [](char t) { return t != 0; });
  });
}

Result<Calibration> calibrate(const capture::Capture& capture, const OpenVideo& open_video,
                              const CalibrationOptions& options,
                              const std::function<bool(const std::string& what, double share)>& on_progress) {
  return Calibrator(capture, options, on_progress).run(open_video);
}

void applyCalibration(const Calibration& calibration, capture::Capture& capture) {
  for (size_t c = 0; c < capture.cameras.size(); ++c) capture.cameras[c].pinhole = calibration.cameras[c];
  for (size_t s = 0; s < calibration.sequences.size(); ++s) {
    capture::CaptureSequence& sequence = capture.sequences[s];
    int64_t earliest = 0, latest = 0;  // whole frames beyond those already applied
    bool any = false;
    for (size_t c = 0; c < capture.cameras.size(); ++c) {
      const CameraCalibration& camera = calibration.by_camera[c];
      if (!camera.time_changed[s]) continue;
      any = true;
      // The silhouettes used the nearest pictures by the previous offsets.
      const double so_far = std::round(sequence.offsetOf(camera.name));
      sequence.offset_frames[camera.name] = so_far + camera.times[s].offset_frames;
      const int64_t whole = std::llround(so_far + camera.times[s].offset_frames) - int64_t(so_far);
      earliest = std::min(earliest, whole), latest = std::max(latest, whole);
    }
    if (!any || sequence.loop) continue;
    const auto last = int64_t(sequence.frame_count) - latest + earliest;
    sequence.first_frame += uint32_t(-earliest);
    sequence.frame_count = uint32_t(std::max<int64_t>(1, last));
    std::vector<uint32_t> tests;
    for (const uint32_t frame : sequence.test_frames)
      if (int64_t(frame) + earliest >= 0 && frame + earliest < sequence.frame_count)
        tests.push_back(uint32_t(frame + earliest));
    sequence.test_frames = std::move(tests);
  }
}

}  // namespace fourdvt::refine
