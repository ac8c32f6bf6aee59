// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/camera_assembly.h"

#include <algorithm>

#include "bake/run/character_files.h"
#include "bake/stages/assemble.h"
#include "bake/stages/camera_colours.h"
#include "bake/stages/sound_stage.h"
#include "bake/stages/start_stage.h"
#include "base/bytes.h"
#include "base/hash.h"
#include "encode/surfaces.h"
#include "package/writer.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "render/cameras/fvvr.h"

namespace fourdvt::bake {
namespace {

struct CameraChunkBytes {
  uint32_t total = 0, surfaces = 0, runs = 0;
  uint64_t hash = 0;
};

// What the tables at a chunk's beginning say (native/package/FORMAT.md).
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

// Writes the sequence's two files and describes it.
Status packSequence(const BakeRun& run, const StreamPlan& plan, package::Character& character, ReportInput& report) {
  const Job& job = run.job;
  package::Sequence s = describeStream(plan);
  FOURDVT_ASSIGN(auto tables, packVideos(plan, run, s));
  ReportTiles tiles = describeTiles(job, plan);
  ReportSequence r;
  package::StreamIndex index;
  index.frame_count = plan.frameCount();
  index.position_origin = job.bounds.min;
  index.position_step_m = static_cast<float>(*job.options.position_step_m);
  index.renditions = std::move(tables);
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(const auto chunk, run.work.load<store::Bytes>(chunkFile(plan.name, g)));
    FOURDVT_ASSIGN(const auto artefact, run.work.load<GopArtefact>(gopFile(plan.name, g)));
    const CameraChunkBytes bytes = measure(chunk);
    index.vertex_count = std::max(index.vertex_count, artefact.frames.vertex_count);
    index.face_count = std::max(index.face_count, artefact.frames.face_count);
    const uint32_t first = plan.gop_first_frames[g];
    index.chunks.push_back({first, plan.gopEnd(g) - first, 0, bytes.total, bytes.hash});
    r.geometry_bytes += bytes.surfaces;
    r.index_bytes += bytes.total - bytes.surfaces;
    tiles.runs += bytes.runs;
    if (g > 0) continue;
    const std::string file = "report_" + plan.name + ".jpg";
    FOURDVT_TRY(platform::writeFileAtomic(job.reportFolder() + "/" + file, artefact.picture_jpeg));
    report.pictures.push_back({file, "The video picture of " + plan.name +
                                         ", frame 0: what each camera shows of the performer, and the barcode."});
  }
  tiles.vertices = index.vertex_count;
  tiles.faces = index.face_count;
  character.vertex_count = std::max(character.vertex_count, index.vertex_count);
  character.face_count = std::max(character.face_count, index.face_count);
  FOURDVT_TRY(writeStream(std::move(index), run, plan, s));
  r.name = s.name;
  r.frames = s.frame_count;
  r.gops = static_cast<uint32_t>(plan.gop_first_frames.size());
  r.fps = s.fps;
  r.loop = s.loop;
  describeRenditions(s, r);
  r.index_bytes += s.stream_header_bytes;
  r.tiles = tiles;
  report.sequences.push_back(std::move(r));
  character.sequences.push_back(std::move(s));
  return {};
}

// The first frame, its pictures in the colours that the cameras share.
Result<capture::CaptureFrame> readFirstFrame(const BakeRun& run, const std::vector<ColourMap>& maps) {
  const Job& job = run.job;
  FOURDVT_ASSIGN(const auto reader,
                 capture::FrameReader::open(job.capture, job.capture.sequences[0], run.environment.open_video));
  FOURDVT_ASSIGN(auto frame, reader->next());
  for (size_t c = 0; c < maps.size(); ++c) applyColours(maps[c], frame.pictures[c]);
  return frame;
}

// It from the view that the page starts with, textured by FVVR, which reads the cameras' whole pictures.
Result<Image> drawPoster(const BakeRun& run, const capture::CaptureFrame& frame) {
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

// Draws the poster, and colours the mesh for viewers that read glTF alone. Holds one picture of every camera meanwhile.
Status drawStills(BakeRun& run, const std::vector<ColourMap>& maps) {
  Job& job = run.job;
  FOURDVT_ASSIGN(const auto first, readFirstFrame(run, maps));
  FOURDVT_ASSIGN(const auto poster, drawPoster(run, first));
  FOURDVT_ASSIGN(const auto webp, platform::encodeImage(poster, ".webp", 85));
  FOURDVT_TRY(platform::writeFileAtomic(job.resultFolder() + "/" + kPosterFile, webp));
  const TriangleMesh surface{job.mesh.decoded.positions, job.mesh.decoded.topology.face_vertices};
  FOURDVT_ASSIGN(job.mesh,
                 package::encodePlainMesh(surface, encode::vertexColours(surface, job.cameras, first.pictures)));
  return {};
}

}  // namespace

Status assembleCameras(BakeRun& run, const std::vector<ColourMap>& maps, const std::optional<BakedRoom>& room,
                       ReportInput& report) {
  StageClock::Span span(run.clock, Stage::Assemble);
  const Job& job = run.job;
  const std::string folder = job.resultFolder() + "/";
  FOURDVT_TRY(makeResultFolders(job));
  FOURDVT_TRY(drawStills(run, maps));
  report.pictures = {{kPosterFile, "The character, " + job.streams[0].name +
                                       ", frame 0, as the page shows it first, from the three nearest cameras."}};
  package::Character character = describeCharacter(job);
  if (report.figures.method) {
    character.method.name = report.figures.method->method;
    character.method.sweep_band_m = report.figures.method->sweep_band_m.value_or(0);
  }
  for (const StreamPlan& plan : job.streams) FOURDVT_TRY(packSequence(run, plan, character, report));
  FOURDVT_ASSIGN(character.mesh_uri, writeNamed(job.resultFolder(), kMeshFile, job.mesh.bytes));
  FOURDVT_TRY(writeRoom(job, room, character, report));
  FOURDVT_TRY(writeStart(run, character, report));
  FOURDVT_ASSIGN(const auto sounds, writeSounds(run, report));
  FOURDVT_ASSIGN(const auto manifest,
                 package::writeManifest({character, &job.mesh, "", kGenerator, job.capture.credit, sounds}));
  FOURDVT_TRY(platform::writeFileAtomic(folder + kManifestFile, manifest));
  report.picture_width = job.streams[0].layout().width;
  report.picture_height = job.streams[0].layout().height;
  describeCommon(job, character, report);
  return describeRefinement(job, report);
}

}  // namespace fourdvt::bake
