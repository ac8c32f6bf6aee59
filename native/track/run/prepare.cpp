// SPDX-License-Identifier: Apache-2.0
#include "track/run/prepare.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "capture/folder/linked_capture.h"
#include "capture/input_files.h"
#include "mattes/frame_reader.h"
#include "track/mesh/genus_zero.h"
#include "track/mesh/nearest.h"

namespace fourdvt::track {
namespace {

const capture::FolderWriter kWriter{"track", kTrackJson, ""};
constexpr const char* kVersion = "track 2";  // increment when the same options give other meshes

constexpr int kCropMargin_px = 24;
constexpr uint32_t kMaxJudged = 24;       // frames that are looked at for the template
constexpr double kVoxel_m = 0.005;        // grid for a life-size template
constexpr double kJudgedVoxel_m = 0.010;  // grid for candidates

// Surface of one frame, made closed, and its suitability.
struct Candidate {
  GenusZeroSurface closed;
  TemplateFitness fitness;
  double overlap = 0;
};

// Positions on the frame's own surface, where it is near: the grid of the closed one is coarser.
Positions drawnTo(const TriangleMesh& surface, const TemplateMesh& mesh, float within_m) {
  const NearestSurface nearest(surface);
  const std::vector<glm::vec3> normals = normalsOf(mesh.topology.face_vertices, mesh.positions);
  Positions out = mesh.positions;
  for (size_t v = 0; v < out.size(); ++v)
    if (const auto hit = nearest.nearestFacing(out[v], normals[v], 0.7f, within_m)) out[v] = hit->point;
  return out;
}

class TemplateChoice {
 public:
  TemplateChoice(const Prepared& job, const Work& work, const TrackEnvironment& environment)
      : job_(job), work_(work), environment_(environment), list_(work.frames()) {}

  Result<ChosenTemplate> make() {
    ChosenTemplate out;
    if (job_.options.template_frame) {
      FOURDVT_ASSIGN(out.frame, givenFrame());
    } else {
      FOURDVT_TRY(choose(out));
    }
    FOURDVT_ASSIGN(const Candidate candidate, candidateOf(out.frame, kVoxel_m));
    out.fitness = candidate.fitness;
    FOURDVT_TRY(check(out.frame, candidate));
    FOURDVT_ASSIGN(const FramePictures pictures, work_.pictures(out.frame));
    FOURDVT_ASSIGN(out.mesh, templateMesh(candidate.closed.mesh, pictures.views, job_.options.mesh));
    FOURDVT_ASSIGN(const TriangleMesh surface, surfaceOf(job_, work_, out.frame));
    out.mesh.positions = drawnTo(surface, out.mesh, float(kVoxel_m));
    const NearestSurface nearest(surface);
    out.mesh.positions = refined(makeTemplate(out.mesh.topology, out.mesh.positions, job_.options.nodes, surface),
                                 {&surface, &nearest, &pictures.views}, job_.options.fit);
    FOURDVT_TRY(work_.save(out));
    return out;
  }

 private:
  Result<uint32_t> givenFrame() const {
    const FrameName& name = *job_.options.template_frame;
    for (uint32_t s = 0; s < job_.capture.sequences.size(); ++s) {
      const capture::CaptureSequence& sequence = job_.capture.sequences[s];
      if (sequence.name == name.sequence && name.frame < sequence.frame_count) return list_.starts[s] + name.frame;
    }
    return Error{ErrorId::InvalidArgument, "--template " + name.sequence + ":" + std::to_string(name.frame) + ": " +
                                               job_.options.capture_folder + " has no such frame"};
  }

  // Judges frames evenly over all sequences, takes the best.
  Status choose(ChosenTemplate& out) const {
    const uint32_t step = std::max(1u, (list_.count + kMaxJudged - 1) / kMaxJudged);
    double best = -1e9;
    for (uint32_t frame = step / 2; frame < list_.count; frame += step) {
      FOURDVT_TRY(stopped(job_, environment_));
      if (environment_.progress) environment_.progress({"template: " + work_.nameOf(frame), frame, list_.count, 0, 0});
      FOURDVT_ASSIGN(const Candidate candidate, candidateOf(frame, kJudgedVoxel_m));
      const double score = candidate.fitness.score() * candidate.overlap;
      out.judged.push_back({frame, score});
      if (score > best) best = score, out.frame = frame;
    }
    return {};
  }

  Result<Candidate> candidateOf(uint32_t frame, double voxel_m) const {
    FOURDVT_ASSIGN(const TriangleMesh surface, surfaceOf(job_, work_, frame));
    FOURDVT_ASSIGN(const FramePictures pictures, work_.pictures(frame));
    const double scale = lengthScale({longestSide(surface.positions)});
    Candidate out;
    auto closed = genusZeroSurface(surface, voxel_m / scale);
    if (!closed.ok()) return Error{closed.error().id, work_.nameOf(frame) + ": " + closed.error().message};
    out.closed = closed.take();
    out.fitness = fitnessOf(out.closed.mesh, out.closed.cut_m3, out.closed.other_m3, pictures.views);
    out.overlap = overlapWith(out.closed.mesh.faces, out.closed.mesh.positions, pictures.views).mean;
    return out;
  }

  Status check(uint32_t frame, const Candidate& candidate) const {
    const std::string problem =
        templateProblem(candidate.fitness, candidate.overlap, job_.options.template_frame.has_value());
    if (problem.empty()) return {};
    return Error{ErrorId::InvalidArgument, job_.options.capture_folder + ", " + work_.nameOf(frame) + ": " + problem};
  }

  const Prepared& job_;
  const Work& work_;
  const TrackEnvironment& environment_;
  const FrameList& list_;
};

}  // namespace

capture::ResultFolder resultFolder(const TrackOptions& options) { return {options.folder, kWriter}; }

Status stopped(const Prepared& job, const TrackEnvironment& environment) {
  if (!environment.stop || !*environment.stop) return {};
  return Error{ErrorId::Interrupted,
               "stopped; finished frames are kept in " + resultFolder(job.options).workFolder() + " for --resume"};
}

Result<TriangleMesh> surfaceOf(const Prepared& job, const Work& work, uint32_t frame) {
  const uint32_t s = work.frames().sequenceOf(frame);
  return capture::readSurfaceFrame(job.capture, job.capture.sequences[s], frame - work.frames().starts[s]);
}

std::string settingsKey(const TrackOptions& o, const capture::Capture& capture) {
  std::string key = capture::inputsKey(capture);
  for (const capture::CaptureSequence& sequence : capture.sequences)
    key += " " + hexDigits(capture::meshDigest(sequence));
  key += printed(
      " %s faces %u texels %d gutter %d nodes %u flow %d %d surface %.9g rigid %.9g smooth %.9g offset %.9g "
      "outline %.9g similarity %d",
      kVersion, o.mesh.faces, o.mesh.texels, o.mesh.gutter_texels, o.nodes, int(o.fit.flow_from_parent),
      int(o.fit.flow_from_anchor), o.fit.surface_sigma_m, o.fit.rigidity_sigma_m, o.fit.smoothness_sigma_m,
      o.fit.offset_sigma_m, o.fit.outline_sigma_px, int(o.by_similarity));
  if (o.template_frame)
    key += " template " + o.template_frame->sequence + " " + std::to_string(o.template_frame->frame);
  return key + "\n";
}

Result<Prepared> prepare(const TrackOptions& given, capture::Earlier earlier, const TrackEnvironment& environment) {
  Prepared out{given, {}, {}};
  TrackOptions& options = out.options;
  FOURDVT_ASSIGN(options.folder, capture::checkedTarget(options.folder, options.capture_folder, kWriter));
  FOURDVT_ASSIGN(out.capture, mattes::openCapture(options.capture_folder, environment.open_video, options.sequences,
                                                  capture::MeshNeed::AnySurface));
  options.capture_folder = out.capture.folder;
  options.sequences.clear();
  for (const capture::CaptureSequence& sequence : out.capture.sequences) options.sequences.push_back(sequence.name);
  FOURDVT_ASSIGN(out.settings_key,
                 resultFolder(options).openFor(settingsKey(options, out.capture), earlier, environment.note));
  return out;
}

Status storePictures(const Prepared& job, const Work& work, const TrackEnvironment& environment) {
  FOURDVT_TRY(work.makeFolders());
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : job.capture.cameras) cameras.push_back(camera.pinhole);
  for (uint32_t s = 0; s < job.capture.sequences.size(); ++s) {
    capture::CaptureSequence sequence = job.capture.sequences[s];
    const uint32_t first = work.frames().starts[s];
    std::unique_ptr<mattes::FrameReader> reader;
    for (uint32_t f = 0; f < sequence.frame_count; ++f) {
      if (work.hasPictures(first + f)) continue;
      FOURDVT_TRY(stopped(job, environment));
      if (environment.progress)
        environment.progress({"pictures: " + work.nameOf(first + f), first + f, work.frames().count, 0, 0});
      if (!reader) {
        FOURDVT_ASSIGN(reader, mattes::FrameReader::open(job.capture, sequence, environment.open_video, f));
      }
      reader->skipTo(f);
      FOURDVT_ASSIGN(const auto captured, reader->next());
      FOURDVT_TRY(work.save(first + f, FramePictures{viewsOf(cameras, captured.pictures, kCropMargin_px)},
                            thumbnailsOf(captured.pictures)));
    }
  }
  return {};
}

Result<ChosenTemplate> makeTemplateOf(const Prepared& job, const Work& work, const TrackEnvironment& environment) {
  if (auto found = work.chosenTemplate()) return std::move(*found);
  return TemplateChoice(job, work, environment).make();
}

}  // namespace fourdvt::track
