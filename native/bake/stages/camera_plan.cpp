// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>

#include "bake/run/renditions.h"
#include "bake/stages/stages.h"
#include "base/mesh.h"
#include "encode/surfaces.h"
#include "mattes/frame_reader.h"

namespace fourdvt::bake {
namespace {

using package::Rect;

struct Surfaces {
  BoundingBox bounds;
  bool any = false;
  size_t vertices = 0, faces = 0;  // maximum over all frames
  std::vector<double> sides_m;     // longest side of each frame
};

void add(Surfaces& all, const TriangleMesh& surface) {
  if (!all.any) all.bounds = {surface.positions[0], surface.positions[0]};
  all.any = true;
  all.sides_m.push_back(longestSide(surface.positions));
  all.vertices = std::max(all.vertices, surface.positions.size());
  all.faces = std::max(all.faces, surface.faces.size());
  all.bounds.grow(surface.positions);
}

// Maximum number of faces of a streamed surface; 0: unlimited.
uint64_t maxFaces(const Job& job) { return job.oneTopology() ? 0 : uint64_t(job.options.cameras.faces); }

// A simplified surface has at most as many vertices as faces, unless its faces share none.
Status checkLimit(const Job& job, const std::string& file, const TriangleMesh& surface) {
  uint64_t vertices = surface.positions.size(), faces = surface.faces.size();
  if (const uint64_t most = maxFaces(job); most > 0 && most < faces) vertices = std::min(vertices, faces = most);
  return checkSurface(file, vertices, faces);
}

std::vector<Rect> regionsOf(const Job& job, const Positions& surface) {
  std::vector<Rect> out;
  for (const PinholeCamera& camera : job.cameras) out.push_back(encode::regionOfInterest(camera, surface));
  return out;
}

// Rejects sequences whose first frames alone need a tiled picture that is too large, before all surfaces are read.
Status checkFirstFrames(const Job& job) {
  const CameraOptions& o = job.options.cameras;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    FOURDVT_ASSIGN(const auto surface, capture::readSurfaceFrame(job.capture, sequence, 0));
    const encode::CameraLayout least =
        encode::planCameraLayout(job.cameras, {regionsOf(job, surface.positions)}, o.tile_scale);
    if (const std::string wrong = encode::checkCameraLayout(least, o.tile_scale, o.max_texels); !wrong.empty())
      return Error{ErrorId::InvalidArgument, "sequence '" + sequence.name + "', frame 0 alone: " + wrong};
  }
  return {};
}

// Shortens GOPs that would take more memory than players allow.
void shortenGops(Job& job, const Surfaces& all) {
  uint64_t vertices = all.vertices, faces = all.faces;
  if (const uint64_t most = maxFaces(job); most > 0) {
    faces = std::min(faces, most);
    vertices = std::min(vertices, faces);  // a closed surface has half as many
  }
  const uint64_t frames = package::kMaxDecodedChunkBytes / ((vertices + faces) * 14);  // 12 bytes each, and a margin
  job.options.gop = static_cast<int>(std::clamp<uint64_t>(frames, 1, uint64_t(job.options.gop)));
}

std::vector<std::vector<Rect>> regionsOfGops(const Job& job, size_t sequence, const std::vector<uint32_t>& first) {
  const auto& frames = job.regions[sequence];
  std::vector<std::vector<Rect>> out;
  for (size_t g = 0; g < first.size(); ++g) {
    const size_t end = g + 1 < first.size() ? first[g + 1] : frames.size();
    std::vector<Rect>& gop = out.emplace_back(job.cameras.size());
    for (size_t f = first[g]; f < end; ++f)
      for (size_t c = 0; c < gop.size(); ++c) gop[c] = encode::united(gop[c], frames[f][c]);
  }
  return out;
}

StreamPlan planStream(const Job& job, size_t number) {
  const capture::CaptureSequence& source = job.capture.sequences[number];
  StreamPlan stream;
  stream.name = source.name;
  stream.motion.frame_count = source.frame_count;
  stream.motion.fps = job.capture.fps;
  stream.motion.loop = source.loop;
  stream.motion.members.emplace_back().source = &source;
  stream.gop_first_frames = encode::planGops(source.frame_count, job.options.gop);
  stream.cameras = encode::planCameraLayout(job.cameras, regionsOfGops(job, number, stream.gop_first_frames),
                                            job.options.cameras.tile_scale);
  RenditionPlan& highest = stream.renditions.emplace_back();
  highest.layout = {stream.cameras.picture_width, stream.cameras.picture_height, {}, stream.cameras.barcode};
  highest.tiles = {0, 0, stream.cameras.width, stream.cameras.height};
  highest.encode = job.encode;
  highest.encode.width = highest.layout.width;
  highest.encode.height = highest.layout.height;
  addLowerRenditions(job.options, stream);
  return stream;
}

// Plans the sequences' streams; returns the bytes of their pictures.
Result<double> planStreamsOf(Job& job, const std::function<void(size_t sequence)>& begins) {
  job.streams.clear();
  double bytes = 0;
  for (size_t s = 0; s < job.capture.sequences.size(); ++s) {
    begins(s);
    job.streams.push_back(planStream(job, s));
    const encode::CameraLayout& layout = job.streams.back().cameras;
    const std::string wrong =
        encode::checkCameraLayout(layout, job.options.cameras.tile_scale, job.options.cameras.max_texels);
    if (!wrong.empty())
      return Error{ErrorId::InvalidArgument, "sequence '" + job.capture.sequences[s].name + "': " + wrong};
    bytes += layout.pictureTexels() * kVideoBytesPerTexel * job.streams.back().frameCount();
  }
  return bytes;
}

}  // namespace

TriangleMesh streamedSurface(const Job& job, const mattes::CaptureFrame& frame) {
  if (job.oneTopology()) return {frame.positions, job.capture.topology.face_vertices};
  return encode::simplified({frame.positions, frame.faces}, static_cast<size_t>(job.options.cameras.faces));
}

Status planCameraSurfaces(Job& job, const BakeEnvironment& environment) {
  FOURDVT_TRY(checkFirstFrames(job));
  Surfaces all;
  bool seen = false;
  job.regions.assign(job.capture.sequences.size(), {});
  for (size_t s = 0; s < job.capture.sequences.size(); ++s) {
    const capture::CaptureSequence& sequence = job.capture.sequences[s];
    for (uint32_t f = 0; f < sequence.frame_count; ++f) {
      if (environment.stop && *environment.stop) return Error{ErrorId::Interrupted, "stopped; nothing was written"};
      FOURDVT_ASSIGN(const auto surface, capture::readSurfaceFrame(job.capture, sequence, f));
      FOURDVT_TRY(checkLimit(job, meshFile(sequence, f), surface));
      if (s == 0 && f == 0) {
        FOURDVT_ASSIGN(job.mesh,
                       package::encodePlainMesh(encode::simplified(surface, size_t(job.options.cameras.faces))));
      }
      add(all, surface);
      job.regions[s].push_back(regionsOf(job, surface.positions));
      for (const Rect& region : job.regions[s].back()) seen |= region.width > 0;
    }
  }
  job.bounds = all.bounds;
  if (!seen)
    return Error{ErrorId::NothingVisible, job.capture.folder +
                                              ": no camera sees any surface: check the axes and units of meshes and "
                                              "cameras"};
  shortenGops(job, all);
  FOURDVT_TRY(settleLengths(job, std::move(all.sides_m)));
  // Refinement is long work and hardly moves the surface.
  if (!job.options.refine.any() || job.refinement) return {};
  FOURDVT_ASSIGN([[maybe_unused]] const double bytes, planStreamsOf(job, [](size_t) {}));
  return {};
}

Status planCameraStreams(BakeRun& run) {
  StageClock::Span span(run.clock, Stage::Regions);
  Job& job = run.job;
  StageProgress progress(run.progress, infoOf(Stage::Regions).work_s * job.total_frames);
  const auto begins = [&](size_t s) {
    progress.done(double(s) / job.capture.sequences.size(), "regions " + job.capture.sequences[s].name);
  };
  FOURDVT_ASSIGN(const double bytes, planStreamsOf(job, begins));
  return checkSpace(job, bytes * ladderTexels(job.options));
}

}  // namespace fourdvt::bake
