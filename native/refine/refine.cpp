// SPDX-License-Identifier: Apache-2.0
#include "refine/refine.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/robust.h"
#include "mattes/frame_reader.h"
#include "refine/camera_fit.h"
#include "refine/frames.h"
#include "refine/outline.h"
#include "refine/surface_fit.h"

namespace fourdvt::refine {
namespace {

// Minimum measured bias of the mattes that is corrected: below are the errors of keyers, codecs and textures.
constexpr double kMinBiasPixels = 0.25;
// A mesh stays as given if the median of its residuals is below kExactPixels and their 95 % quantile below
// kExactP95Pixels: biases of mattes and mesh below kMinBiasPixels are not distinguishable.
constexpr double kExactPixels = kMinBiasPixels, kExactP95Pixels = 1;
constexpr size_t kMinMatteEdges = 200;
constexpr size_t kCameraFrames = 10;  // maximum number of frames for the fit of a camera
constexpr int kSurfaceRounds = 5;
constexpr float kFurthest_m = 0.015f;  // maximum displacement of a vertex, time-varying offsets included
constexpr double kMinGain = 0.01;      // minimum relative reduction of the residual by another round
constexpr int kCameraRounds = 2;       // fits of the cameras to the corrected mesh
constexpr double kBlock_m = 0.2;       // side of a block of the surface
constexpr size_t kWorstPictures = 3;
constexpr uint32_t kMinOfPicture = 50;  // minimum number of points for a picture among the worst

Residuals summary(const std::vector<double>& residuals) {
  std::vector<double> sizes;
  for (const double r : residuals) sizes.push_back(std::abs(r));
  return {static_cast<uint32_t>(residuals.size()), quantile(residuals, 0.5), quantile(sizes, 0.5),
          quantile(sizes, 0.95)};
}

Histogram histogramOf(const std::vector<double>& residuals) {
  const int bins = static_cast<int>(2 * kReachPixels / kBinPixels);
  Histogram out(bins);
  for (const double r : residuals)
    out[std::clamp(static_cast<int>(std::floor((r + kReachPixels) / kBinPixels)), 0, bins - 1)] +=
        1.0 / double(residuals.size());
  return out;
}

// [vertex] block by the grid of cubes on the first mesh.
std::vector<uint32_t> blocksOf(const Positions& positions) {
  std::map<std::array<int, 3>, uint32_t> known;
  std::vector<uint32_t> out;
  for (const glm::vec3& p : positions) {
    const glm::ivec3 cube = glm::floor(p / float(kBlock_m));
    out.push_back(known.emplace(std::array{cube.x, cube.y, cube.z}, static_cast<uint32_t>(known.size())).first->second);
  }
  return out;
}

class Refiner {
 public:
  using Progress = std::function<bool(const std::string&, double)>;
  Refiner(const capture::Capture& capture, const RefineOptions& options, const Progress& progress)
      : capture_(capture), options_(options), progress_(progress) {}

  Result<Refinement> run(const OpenVideo& open_video);

 private:
  using Offsets = std::vector<float>;
  // [frame][camera]
  using AllPoints = std::vector<std::vector<std::vector<OutlinePoint>>>;

  Status read(const OpenVideo& open_video);
  Status tell(const std::string& what, double share) const;
  void findClearances();
  void useMatteBias(const std::vector<std::vector<double>>& edges);
  void moveMeshes();  // by offsets_
  AllPoints measureAll() const;
  std::vector<BlockedPoint> pointsOf(size_t camera, const PinholeCamera& as, float reach) const;
  bool refitCamera(size_t camera, bool with_position);  // returns true if it changed
  bool fitCameras(bool with_position);                  // returns true if any changed
  // True if offsets fitted to half of the cameras reduce the residuals of the other half.
  bool supported(const AllPoints& points) const;
  bool alreadyExact(const AllPoints& points) const;
  void fitSurface();
  std::map<std::string, capture::SlowOffsets> fitSlow();
  void record(const AllPoints& points, bool after);
  Status drawWorst(const OpenVideo& open_video);
  bool noPointsAtAll() const {
    return std::all_of(out_.by_camera.begin(), out_.by_camera.end(),
                       [](const CameraRefinement& camera) { return camera.before.points == 0; });
  }

  const capture::Capture& capture_;
  const RefineOptions options_;
  const Progress& progress_;
  std::vector<uint32_t> same_as_, blocks_;
  std::vector<glm::uvec3> faces_;
  std::vector<InnerEdge> edges_;
  std::vector<RefineFrame> frames_;
  std::vector<size_t> camera_frames_;  // indices into frames_ for camera fits
  std::vector<Clearance> clearances_;  // present in more than half of the frames
  Offsets offsets_;
  bool moved_any_ = false;     // offsets were fitted
  bool exact_ = false;         // offsets are used for the cameras' fit only; the mesh stays as given
  std::vector<Offsets> slow_;  // [frame] time-varying departures, or empty
  struct Moved {
    Positions positions;
    std::vector<glm::vec3> normals;
  };
  std::vector<Moved> moved_;  // [frame]
  Refinement out_;
};

Status Refiner::tell(const std::string& what, double share) const {
  if (progress_(what, share)) return {};
  return Error{ErrorId::Interrupted, "stopped; the refinement was not saved, run the same command again"};
}

Status Refiner::read(const OpenVideo& open_video) {
  FOURDVT_ASSIGN(const auto first, capture::readMeshFrame(capture_, capture_.sequences.front(), 0));
  same_as_ = capture::weldedVertices(first);
  faces_ = capture::weldedFaces(capture_.topology, same_as_);
  blocks_ = blocksOf(first);
  edges_ = innerEdges(faces_);
  FOURDVT_ASSIGN(auto read, readRefineFrames(capture_, open_video, faces_, [&](double share) {
                   return progress_("outline " + std::to_string(static_cast<int>(100 * share)) + " %", 0.6 * share);
                 }));
  frames_ = std::move(read.frames);
  const size_t stride = (frames_.size() + kCameraFrames - 1) / kCameraFrames;
  for (size_t f = 0; f < frames_.size(); f += stride) camera_frames_.push_back(f);
  offsets_.assign(first.size(), 0);
  out_.frames = static_cast<uint32_t>(frames_.size());
  for (const capture::CaptureCamera& camera : capture_.cameras) {
    out_.cameras.push_back(camera.pinhole);
    out_.by_camera.push_back({.name = camera.pinhole.name});
  }
  useMatteBias(read.matte_edges);
  findClearances();
  return {};
}

void Refiner::findClearances() {
  std::vector<std::vector<Clearance>> all(camera_frames_.size());
  inParallel(all.size(), [&](int i) {
    const RefineFrame& frame = frames_[camera_frames_[i]];
    all[i] = clearancesOf(faces_, frame.positions, frame.normals, kFurthest_m);
  });
  std::vector<Clearance> together;
  for (const auto& of_frame : all) together.insert(together.end(), of_frame.begin(), of_frame.end());
  clearances_ = usualClearances(std::move(together), all.size());
}

void Refiner::useMatteBias(const std::vector<std::vector<double>>& edges) {
  for (size_t c = 0; c < edges.size(); ++c) {
    CameraRefinement& camera = out_.by_camera[c];
    if (edges[c].size() >= kMinMatteEdges) camera.measured_bias_pixels = quantile(edges[c], 0.5);
    const double measured = camera.measured_bias_pixels.value_or(0);
    camera.used_bias_pixels = options_.matte_bias_pixels.value_or(std::abs(measured) < kMinBiasPixels ? 0 : measured);
  }
}

void Refiner::moveMeshes() {
  moved_.resize(frames_.size());
  inParallel(frames_.size(), [&](int f) {
    const RefineFrame& frame = frames_[f];
    Moved& moved = moved_[f];
    moved.positions = frame.positions;
    for (size_t v = 0; v < offsets_.size(); ++v) {
      const uint32_t place = same_as_[v];
      const float offset = offsets_[place] + (slow_.empty() ? 0 : slow_[f][place]);
      moved.positions[v] += offset * frame.normals[place];
    }
    computeVertexNormals(faces_, moved.positions.data(), moved.positions.size(), moved.normals);
  });
}

Refiner::AllPoints Refiner::measureAll() const {
  AllPoints all(frames_.size(), std::vector<std::vector<OutlinePoint>>(out_.cameras.size()));
  const int cameras = static_cast<int>(out_.cameras.size());
  inParallel(static_cast<int>(frames_.size()) * cameras, [&](int i) {
    const int f = i / cameras, c = i % cameras;
    OutlineOptions options;
    options.matte_bias_pixels = static_cast<float>(out_.by_camera[c].used_bias_pixels);
    all[f][c] = outlinePoints(out_.cameras[c], faces_, edges_, moved_[f].positions, moved_[f].normals,
                              frames_[f].mattes[c], options);
  });
  return all;
}

std::vector<BlockedPoint> Refiner::pointsOf(size_t camera, const PinholeCamera& as, float reach) const {
  OutlineOptions options;
  options.reach_pixels = reach;
  options.matte_bias_pixels = static_cast<float>(out_.by_camera[camera].used_bias_pixels);
  std::vector<BlockedPoint> out;
  for (const size_t f : camera_frames_)
    for (const OutlinePoint& point :
         outlinePoints(as, faces_, edges_, moved_[f].positions, moved_[f].normals, frames_[f].mattes[camera], options))
      out.push_back({point, blocks_[point.from]});
  return out;
}

bool Refiner::refitCamera(size_t c, bool with_position) {
  const auto measure = [&](const PinholeCamera& as, float reach) { return pointsOf(c, as, reach); };
  const CameraRefit refit =
      refine::refitCamera(out_.cameras[c], capture_.cameras[c].pinhole, measure, with_position, SurfaceKind::Mesh);
  if (refit.best) {
    out_.by_camera[c].best = refit.best;
    out_.by_camera[c].turn_deviation_deg = refit.turn_deviation_deg;
  }
  out_.cameras[c] = refit.camera;
  return refit.changed;
}

bool Refiner::fitCameras(bool with_position) {
  std::vector<char> changed(out_.cameras.size());
  inParallel(out_.cameras.size(), [&](int c) { changed[c] = refitCamera(c, with_position); });
  return std::any_of(changed.begin(), changed.end(), [](char c) { return c != 0; });
}

bool Refiner::supported(const AllPoints& points) const {
  std::vector<OffsetClaim> half;
  for (const auto& frame : points)
    for (size_t c = 0; c < frame.size(); c += 2)
      for (const OutlinePoint& point : frame[c]) half.push_back(claimOf(point));
  const Offsets offsets = fitOffsets(half, edges_, offsets_, clearances_, {});
  std::vector<double> without, with;
  for (const auto& frame : points)
    for (size_t c = 1; c < frame.size(); c += 2)
      for (const OutlinePoint& s : frame[c]) {
        without.push_back(claimOf(s).offset_m);
        const auto change = [&](uint32_t v) { return offsets[v] - offsets_[v]; };
        with.push_back(without.back() - (1 - s.to_share) * change(s.from) - s.to_share * change(s.to));
      }
  return !half.empty() && !with.empty() && robustScale(with) < robustScale(without);
}

bool Refiner::alreadyExact(const AllPoints& points) const {
  std::vector<double> residuals;
  for (const auto& frame : points)
    for (const auto& of_camera : frame)
      for (const OutlinePoint& point : of_camera) residuals.push_back(point.residual_pixels);
  const Residuals all = summary(residuals);
  return all.points > 0 && all.median_pixels < kExactPixels && all.p95_pixels < kExactP95Pixels;
}

void Refiner::fitSurface() {
  double before = 1e9;
  Offsets offsets_before = offsets_;
  for (int round = 0; round < kSurfaceRounds; ++round) {
    moveMeshes();
    std::vector<OffsetClaim> claims;
    std::vector<double> residuals;
    const AllPoints points = measureAll();
    if (!moved_any_) exact_ = alreadyExact(points);
    if (!moved_any_ && !exact_ && !supported(points)) return;
    moved_any_ = true;
    for (const auto& frame : points)
      for (const auto& of_camera : frame)
        for (const OutlinePoint& point : of_camera) {
          claims.push_back(claimOf(point));
          residuals.push_back(point.residual_pixels);
        }
    const double now = robustScale(residuals);
    if (now > before) offsets_ = offsets_before;
    if (now > (1 - kMinGain) * before) break;
    before = now;
    offsets_before = offsets_;
    offsets_ = fitOffsets(claims, edges_, offsets_, clearances_, {});
    ++out_.rounds;
  }
}

std::map<std::string, capture::SlowOffsets> Refiner::fitSlow() {
  moveMeshes();
  const AllPoints points = measureAll();
  std::map<std::string, capture::SlowOffsets> out;
  slow_.assign(frames_.size(), Offsets(offsets_.size()));
  for (const capture::CaptureSequence& sequence : capture_.sequences) {
    std::vector<SlowFrame> mine;
    std::vector<size_t> places;
    for (size_t f = 0; f < frames_.size(); ++f) {
      if (frames_[f].sequence != &sequence) continue;
      SlowFrame frame{frames_[f].index, {}};
      for (const auto& of_camera : points[f]) {
        frame.claims.emplace_back();
        for (const OutlinePoint& point : of_camera) frame.claims.back().push_back(claimOf(point));
      }
      mine.push_back(std::move(frame));
      places.push_back(f);
    }
    const uint32_t loop = sequence.loop ? sequence.frame_count : 0;
    auto fit = fitSlowOffsets(mine, edges_, offsets_.size(), loop);
    if (!fit) continue;
    for (Offsets& slow : fit->offset_m) {
      for (size_t v = 0; v < slow.size(); ++v) slow[v] += offsets_[v];
      keepClear(clearances_, slow);
      for (size_t v = 0; v < slow.size(); ++v) slow[v] -= offsets_[v];
    }
    for (size_t i = 0; i < places.size(); ++i) slow_[places[i]] = fit->offset_m[i];
    out_.slow.push_back(sequence.name);
    out.emplace(sequence.name, std::move(*fit));
  }
  if (out.empty()) slow_.clear();
  return out;
}

void Refiner::record(const AllPoints& points, bool after) {
  std::vector<double> all;
  struct OfPicture {
    size_t frame, camera;
    Residuals residuals;
  };
  std::vector<OfPicture> pictures;
  for (size_t c = 0; c < out_.cameras.size(); ++c) {
    std::vector<double> of_camera;
    for (size_t f = 0; f < frames_.size(); ++f) {
      std::vector<double> of_picture;
      for (const OutlinePoint& point : points[f][c]) of_picture.push_back(point.residual_pixels);
      of_camera.insert(of_camera.end(), of_picture.begin(), of_picture.end());
      pictures.push_back({f, c, summary(of_picture)});
    }
    all.insert(all.end(), of_camera.begin(), of_camera.end());
    (after ? out_.by_camera[c].after : out_.by_camera[c].before) = summary(of_camera);
  }
  (after ? out_.after : out_.before) = histogramOf(all);
  if (after) {
    for (WorstPicture& worst : out_.worst)
      for (const OfPicture& picture : pictures)
        if (picture.camera == worst.camera && frames_[picture.frame].index == worst.frame &&
            frames_[picture.frame].sequence->name == worst.sequence)
          worst.after = picture.residuals;
    return;
  }
  std::stable_sort(pictures.begin(), pictures.end(), [](const OfPicture& a, const OfPicture& b) {
    return a.residuals.median_pixels > b.residuals.median_pixels;
  });
  for (const OfPicture& picture : pictures) {
    const auto same = [&](const WorstPicture& w) { return w.camera == picture.camera; };
    if (out_.worst.size() == kWorstPictures || picture.residuals.points < kMinOfPicture ||
        std::any_of(out_.worst.begin(), out_.worst.end(), same))
      continue;
    const RefineFrame& frame = frames_[picture.frame];
    out_.worst.push_back(
        {frame.sequence->name, frame.index, static_cast<uint32_t>(picture.camera), picture.residuals, {}});
  }
}

// Draws the worst views before and after. Requires moved meshes.
Status Refiner::drawWorst(const OpenVideo& open_video) {
  for (WorstPicture& worst : out_.worst) {
    capture::Capture alone = capture_;
    alone.cameras = {capture_.cameras[worst.camera]};
    const capture::CaptureSequence& sequence = *alone.find(worst.sequence);
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(alone, sequence, open_video, worst.frame));
    FOURDVT_ASSIGN(const auto captured, reader->next());
    const auto frame = std::find_if(frames_.begin(), frames_.end(), [&](const RefineFrame& f) {
      return f.sequence->name == worst.sequence && f.index == worst.frame;
    });
    const Moved& moved = moved_[frame - frames_.begin()];
    OutlineOptions options;
    options.matte_bias_pixels = static_cast<float>(out_.by_camera[worst.camera].used_bias_pixels);
    const auto draw = [&](const PinholeCamera& camera, const Positions& positions,
                          const std::vector<glm::vec3>& normals) {
      return outlinePicture(
          captured.pictures[0], camera,
          outlinePoints(camera, faces_, edges_, positions, normals, frame->mattes[worst.camera], options));
    };
    worst.picture = beside(draw(capture_.cameras[worst.camera].pinhole, frame->positions, frame->normals),
                           draw(out_.cameras[worst.camera], moved.positions, moved.normals));
  }
  return {};
}

Result<Refinement> Refiner::run(const OpenVideo& open_video) {
  out_.options = options_;
  FOURDVT_TRY(read(open_video));
  moveMeshes();
  record(measureAll(), false);
  if (options_.cameras) {
    FOURDVT_TRY(tell("cameras", 0.65));
    fitCameras(false);
  }
  FOURDVT_TRY(tell("surface", 0.75));
  fitSurface();
  for (int round = 0; options_.cameras && round < kCameraRounds; ++round) {
    FOURDVT_TRY(tell("cameras", 0.8 + 0.05 * round));
    moveMeshes();
    if (!fitCameras(true)) break;
    fitSurface();
  }
  auto offsets = std::make_shared<capture::SurfaceOffsets>();
  if (options_.outline && (!moved_any_ || exact_))
    out_.note =
        noPointsAtAll() ? "Mesh unchanged: no camera has a matte edge near the mesh's outline. Check the mattes, the "
                          "calibration and the axes."
        : exact_        ? "Mesh unchanged: already within 0.25 px, the accuracy of the mattes."
                 : "Mesh unchanged: the correction from one half of the cameras does not fit the other half. Check the "
                   "calibration and the mattes.";
  const bool moves = options_.outline && moved_any_ && !exact_;
  if (moves) {
    FOURDVT_TRY(tell("surface", 0.95));
    offsets->slow = fitSlow();
  } else {
    std::fill(offsets_.begin(), offsets_.end(), 0.0f);  // used for the cameras' fit only
  }
  moveMeshes();
  record(measureAll(), true);
  FOURDVT_TRY(drawWorst(open_video));
  for (size_t c = 0; c < out_.cameras.size(); ++c) {
    const PinholeCamera &given = capture_.cameras[c].pinhole, &now = out_.cameras[c];
    CameraRefinement& told = out_.by_camera[c];
    const glm::dmat3 turn = glm::dmat3(now.cam_from_world) * glm::transpose(glm::dmat3(given.cam_from_world));
    told.turn_deg =
        kDegrees * 0.5 * glm::dvec3(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0]);
    told.move_m = glm::length(now.centreInWorld() - given.centreInWorld());
    told.zoom_percent = 100 * (now.fx / given.fx - 1);
    told.changed = now.cam_from_world != given.cam_from_world || now.fx != given.fx;
  }
  if (moves) {
    std::vector<double> sorted;
    for (size_t v = 0; v < offsets_.size(); ++v)
      if (same_as_[v] == v) sorted.push_back(offsets_[v]);
    out_.offset_low_m = quantile(sorted, 0.05);
    out_.offset_median_m = quantile(sorted, 0.5);
    out_.offset_high_m = quantile(sorted, 0.95);
    offsets->same_as = same_as_;
    offsets->constant_m = offsets_;
    out_.offsets = std::move(offsets);
  }
  return std::move(out_);
}

}  // namespace

bool Refinement::changedCameras() const {
  return std::any_of(by_camera.begin(), by_camera.end(), [](const CameraRefinement& c) { return c.changed; });
}

Result<Refinement> refineCapture(const capture::Capture& capture, const OpenVideo& open_video,
                                 const RefineOptions& options,
                                 const std::function<bool(const std::string& what, double share)>& on_progress) {
  return Refiner(capture, options, on_progress).run(open_video);
}

void applyRefinement(const Refinement& refinement, capture::Capture& capture) {
  capture.offsets = refinement.offsets;
  for (size_t c = 0; c < capture.cameras.size(); ++c) capture.cameras[c].pinhole = refinement.cameras[c];
}

}  // namespace fourdvt::refine
