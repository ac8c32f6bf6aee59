// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bake/stages/assembly.h"
#include "base/bytes.h"
#include "base/hash.h"
#include "encode/surfaces.h"
#include "mattes/frame_reader.h"
#include "render/cameras/fvvr.h"

namespace fourdvt::bake {
namespace {

struct CameraChunkBytes {
  uint32_t total = 0, surfaces = 0, runs = 0;
  uint64_t hash = 0;
};

// Sizes of a chunk's parts, from the tables at its beginning (native/package/FORMAT.md).
CameraChunkBytes measure(const std::vector<uint8_t>& chunk) {
  ByteReader in(chunk);
  CameraChunkBytes out;
  out.total = static_cast<uint32_t>(chunk.size());
  out.hash = fnv1a(chunk);
  in.bytes(size_t(16) * in.u32());
  out.runs = in.u32();
  for (uint32_t r = 0; r < out.runs && in.ok(); ++r) {
    in.u32();
    out.surfaces += in.u32();
    out.surfaces += in.u32();
  }
  return out;
}

ReportTiles describeTiles(const Job& job, const StreamPlan& plan) {
  ReportTiles out;
  out.width = plan.cameras.width;
  out.height = plan.cameras.height;
  double pictures = 0;
  for (const PinholeCamera& camera : job.cameras) pictures += double(camera.width) * camera.height;
  for (const auto& gop : plan.cameras.gops) {
    double kept = 0, used = 0;
    for (const package::CameraTile& tile : gop) {
      kept += double(tile.source.width) * tile.source.height;
      used += double(tile.tile.width) * tile.tile.height;
    }
    out.kept_share += kept / pictures / double(plan.cameras.gops.size());
    out.used_share += used / (double(out.width) * out.height) / double(plan.cameras.gops.size());
  }
  return out;
}

// First frame, with its pictures after colour calibration.
Result<mattes::CaptureFrame> readFirstFrame(const BakeRun& run, const std::vector<ColourMap>& maps) {
  const Job& job = run.job;
  FOURDVT_ASSIGN(const auto reader,
                 mattes::FrameReader::open(job.capture, job.capture.sequences[0], run.environment.open_video));
  FOURDVT_ASSIGN(auto frame, reader->next());
  for (size_t c = 0; c < maps.size(); ++c) applyColours(maps[c], frame.pictures[c]);
  return frame;
}

// Renders the first frame from the page's initial view, textured by FVVR, which reads the cameras' whole pictures.
Result<Image> drawPoster(const BakeRun& run, const mattes::CaptureFrame& frame) {
  const Job& job = run.job;
  MeshTopology topology;
  topology.vertex_count = static_cast<uint32_t>(frame.positions.size());
  topology.face_vertices = frame.faces.empty() ? job.capture.topology.face_vertices : frame.faces;
  FOURDVT_ASSIGN(const auto fvvr,
                 render::Fvvr::create(run.device(), job.cameras, topology, {}, float(job.length_scale)));
  FOURDVT_TRY(fvvr->setFrame(frame.positions, frame.pictures));
  render::FvvrOptions options;
  options.closest = static_cast<int>(std::min<size_t>(3, job.cameras.size()));
  const OrbitView orbit = defaultOrbit(job.bounds, double(kPosterWidth) / kPosterHeight);
  const auto scale = static_cast<float>(job.length_scale);
  const PinholeCamera camera = cameraFromOrbit(orbit, kPosterWidth, kPosterHeight);
  return fvvr->renderStill(render::viewFromCamera(camera, {scale, scale}), options);
}

}  // namespace

Status packSurfaces(const BakeRun& run, const StreamPlan& plan, package::Character& character, ReportInput& report) {
  package::Sequence s = describeStream(plan);
  FOURDVT_ASSIGN(auto tables, packVideos(plan, run, s));
  ReportTiles tiles = describeTiles(run.job, plan);
  uint64_t surface_bytes = 0, other_bytes = 0;
  package::StreamIndex index = streamIndex(run.job, plan, std::move(tables));
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(const auto chunk, run.work.load<store::Bytes>(chunkFile(plan.name, g)));
    FOURDVT_ASSIGN(const auto artefact, run.work.load<GopArtefact>(gopFile(plan.name, g)));
    const CameraChunkBytes bytes = measure(chunk);
    index.vertex_count = std::max(index.vertex_count, artefact.frames.vertex_count);
    index.face_count = std::max(index.face_count, artefact.frames.face_count);
    addChunk(plan, g, bytes.total, bytes.hash, index);
    surface_bytes += bytes.surfaces;
    other_bytes += bytes.total - bytes.surfaces;
    tiles.runs += bytes.runs;
    if (g == 0)
      FOURDVT_TRY(reportPicture(run.job, plan, artefact.picture_jpeg,
                                "what each camera shows of the performer, and the barcode.", report));
  }
  tiles.vertices = index.vertex_count;
  tiles.faces = index.face_count;
  character.vertex_count = std::max(character.vertex_count, index.vertex_count);
  character.face_count = std::max(character.face_count, index.face_count);
  FOURDVT_TRY(writeStream(std::move(index), run, plan, s));
  ReportSequence& r = report.sequences.emplace_back(reportSequence(s, plan));
  r.geometry_bytes = surface_bytes;
  r.index_bytes += other_bytes;
  r.tiles = tiles;
  character.sequences.push_back(std::move(s));
  return {};
}

Status drawCameraStills(BakeRun& run, const std::vector<ColourMap>& maps, ReportInput& report) {
  Job& job = run.job;
  FOURDVT_ASSIGN(const auto first, readFirstFrame(run, maps));
  FOURDVT_ASSIGN(const auto poster, drawPoster(run, first));
  FOURDVT_TRY(writePoster(job, poster));
  report.pictures = {{kPosterFile, "The character, " + job.streams[0].name +
                                       ", frame 0, as the page shows it first, from the three nearest cameras."}};
  const TriangleMesh surface{job.mesh.decoded.positions, job.mesh.decoded.topology.face_vertices};
  FOURDVT_ASSIGN(job.mesh,
                 package::encodePlainMesh(surface, encode::vertexColours(surface, job.cameras, first.pictures)));
  return {};
}

}  // namespace fourdvt::bake
