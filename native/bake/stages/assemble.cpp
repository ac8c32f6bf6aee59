// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/assembly.h"
#include "base/hash.h"
#include "motion/blend.h"
#include "package/start_file.h"
#include "package/writer.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kGraph = "motion.bin";  // without its hash
constexpr const char* kStartFile = "character.start.bin";
// Maximum bytes of headers in the start file: they delay the first picture, and save the data after it a round trip.
constexpr size_t kMaxHeaderBytes = 4096;

// Makes empty folders for the character and its report.
Status makeResultFolders(const Job& job) {
  for (const std::string& folder : {job.resultFolder(), job.reportFolder()}) {
    platform::removeFolder(folder);
    FOURDVT_TRY(platform::makeFolder(folder));
  }
  return {};
}

// Writes the graph; nothing if it is empty.
Status writeGraph(const Job& job, const std::vector<uint8_t>& graph, package::Character& character,
                  ReportInput& report) {
  if (graph.empty()) return {};
  FOURDVT_ASSIGN(character.graph_uri, writeNamed(job.resultFolder(), kGraph, graph));
  character.graph_bytes = graph.size();
  character.graph_hash = fnv1a(graph);
  report.figures.bytes_by_part[character.graph_uri] = graph.size();
  return {};
}

// Writes the room's picture and names it in the manifest; nothing without a room.
Status writeRoom(const Job& job, const std::optional<BakedRoom>& room, package::Character& character,
                 ReportInput& report) {
  if (!room) return {};
  character.room = room->room;
  FOURDVT_ASSIGN(const std::string file, writeNamed(job.resultFolder(), room->room.picture_uri, room->picture));
  character.room.picture_uri = file;
  report.figures.bytes_by_part[file] = room->picture.size();
  report.pictures.push_back(
      {file, "The room's faces, from the plates: floor and ceiling, walls along z, walls along x."});
  return {};
}

// Writes the start file (package/start_file.h), cut out of the first sequence's finished files: only one frame's
// geometry is encoded anew. Names it in the manifest.
Status writeStart(const BakeRun& run, package::Character& character, ReportInput& report) {
  const Job& job = run.job;
  const std::string folder = job.resultFolder() + "/";
  const package::Sequence& s = character.sequences[0];
  FOURDVT_ASSIGN(const auto header, platform::readFileRange(folder + s.stream_uri, 0, s.stream_header_bytes));
  FOURDVT_ASSIGN(auto index, package::readStreamHeader(header));
  const bool coarse = s.hasCoarseGeometry(0);
  FOURDVT_ASSIGN(const auto gop, run.work.load<store::Bytes>(
                                     chunkFile(job.streams[0].name, 0, coarse ? Precision::Coarse : Precision::Fine)));
  const package::VideoSample key = index.renditions[0].samples[0];
  FOURDVT_ASSIGN(const auto video, platform::readFileRange(folder + s.renditions[0].video_uri, key.offset, key.bytes));
  const auto follows = std::span(header).first(header.size() <= kMaxHeaderBytes ? header.size() : 0);
  FOURDVT_ASSIGN(const auto file, job.fromCameras()
                                      ? package::encodeStartFile(index, gop, video, follows, character, s)
                                      : package::encodeStartFile(index, gop, video, follows, job.mesh.decoded));
  character.start = {kStartFile, file.size(), fnv1a(file)};
  report.figures.bytes_by_part[kStartFile] = file.size();
  return platform::writeFileAtomic(folder + kStartFile, file);
}

void describeParts(const Job& job, const package::Character& character, ReportInput& report) {
  report.picture_width = job.streams[0].layout().width;
  report.picture_height = job.streams[0].layout().height;
  report.options = job.options;
  report.capture_name = job.capture.name;
  report.credit = job.capture.credit;
  report.generator = kGenerator;
  report.codec = character.sequences.front().renditions.back().codec;
  report.cameras = static_cast<uint32_t>(job.cameras.size());
  report.vertices = character.vertex_count;
  report.faces = character.face_count;
  report.versions = encoderVersions();
  auto& bytes = report.figures.bytes_by_part;
  for (const std::string& name : {character.mesh_uri, character.poster_uri, std::string(kManifestFile)})
    bytes[name] = platform::fileBytes(job.resultFolder() + "/" + name);
  for (const package::Sequence& s : character.sequences) {
    bytes[s.stream_uri] = s.stream_bytes;
    for (const package::Rendition& rendition : s.renditions) bytes[rendition.video_uri] = rendition.video_bytes;
  }
}

// Reports the refinement: views whose outlines were far off, and the cameras if one of them changed.
Status describeRefinement(const Job& job, ReportInput& report) {
  if (!job.refinement) return {};
  const std::string folder = job.reportFolder() + "/";
  for (const refine::WorstPicture& view : job.refinement->worst) {
    const std::string& camera = job.cameras[view.camera].name;
    const std::string file = "report_outline_" + camera + ".jpg";
    FOURDVT_ASSIGN(auto jpeg, platform::encodeImage(view.picture, ".jpg", 90));
    FOURDVT_TRY(platform::writeFileAtomic(folder + file, jpeg));
    report.outlines.push_back({file, view.sequence + ", frame " + std::to_string(view.frame) + ", " + camera +
                                         ", as given and refined. Green: the outlines agree; red: the mesh is too "
                                         "large; blue: too small (full colour from 2 pixels on)."});
  }
  if (!job.refinement->changedCameras()) return {};
  report.refined_cameras = kRefinedCameras;
  FOURDVT_TRY(platform::makeFolder(folder + kRefinedCameras));
  const capture::ColmapText text = capture::colmapText(job.capture.cameras, job.capture.metres_per_unit);
  FOURDVT_TRY(platform::writeFileAtomic(folder + kRefinedCameras + "/cameras.txt", text.cameras));
  return platform::writeFileAtomic(folder + kRefinedCameras + "/images.txt", text.images);
}

}  // namespace

Status writePoster(const Job& job, const Image& poster) {
  FOURDVT_ASSIGN(const auto webp, platform::encodeImage(poster, ".webp", 85));
  return platform::writeFileAtomic(job.resultFolder() + "/" + kPosterFile, webp);
}

package::StreamIndex streamIndex(const Job& job, const StreamPlan& plan, std::vector<package::SampleTable> tables) {
  package::StreamIndex index;
  index.frame_count = plan.frameCount();
  index.position_origin = job.bounds.min;
  index.position_step_m = static_cast<float>(gridStep_m(job.options));
  index.renditions = std::move(tables);
  return index;
}

void addChunk(const StreamPlan& plan, uint32_t gop, uint32_t bytes, uint64_t hash, package::StreamIndex& index) {
  const uint32_t first = plan.gop_first_frames[gop];
  index.chunks.push_back({first, plan.gopEnd(gop) - first, 0, bytes, hash});
}

ReportSequence reportSequence(const package::Sequence& s, const StreamPlan& plan) {
  ReportSequence r;
  r.name = s.name;
  r.frames = s.frame_count;
  r.gops = static_cast<uint32_t>(plan.gop_first_frames.size());
  r.fps = s.fps;
  r.loop = s.loop;
  if (!s.members.empty()) r.members = static_cast<uint32_t>(s.members.size());
  for (uint32_t i = 0; i < s.renditions.size(); ++i) {
    const package::Rendition& rendition = s.renditions[i];
    r.renditions.push_back({rendition.video_uri, rendition.codec, rendition.width, rendition.height,
                            rendition.video_bytes, s.geometryBytes(i)});
  }
  r.video_bytes = s.renditions.back().video_bytes;
  r.index_bytes = s.stream_header_bytes;
  return r;
}

Status reportPicture(const Job& job, const StreamPlan& plan, const std::vector<uint8_t>& jpeg,
                     const std::string& caption, ReportInput& report) {
  const std::string file = "report_" + plan.name + ".jpg";
  report.pictures.push_back({file, "The video picture of " + plan.name + ", frame 0: " + caption});
  return platform::writeFileAtomic(job.reportFolder() + "/" + file, jpeg);
}

Status assemble(BakeRun& run, const Assembly& parts, ReportInput& report) {
  StageClock::Span span(run.clock, Stage::Assemble);
  const Job& job = run.job;
  FOURDVT_TRY(makeResultFolders(job));
  if (job.fromCameras()) FOURDVT_TRY(drawCameraStills(run, parts.maps, report));
  package::Character character = describeCharacter(job);
  if (report.figures.method)
    character.method = {report.figures.method->method, report.figures.method->sweep_band_m.value_or(0)};
  for (const StreamPlan& plan : job.streams)
    FOURDVT_TRY((job.fromCameras() ? packSurfaces : packLayers)(run, plan, character, report));
  FOURDVT_ASSIGN(character.mesh_uri, writeNamed(job.resultFolder(), kMeshFile, job.mesh.bytes));
  std::string texture;
  if (!job.fromCameras()) {
    FOURDVT_ASSIGN(texture, drawLayeredStills(run, character));
    report.figures.bytes_by_part[texture] = platform::fileBytes(job.resultFolder() + "/" + texture);
  }
  FOURDVT_TRY(writeGraph(job, parts.graph, character, report));
  FOURDVT_TRY(writeRoom(job, parts.room, character, report));
  FOURDVT_TRY(writeStart(run, character, report));
  FOURDVT_ASSIGN(const auto sounds, writeSounds(run, report));
  FOURDVT_ASSIGN(const auto manifest,
                 package::writeManifest({character, &job.mesh, texture, kGenerator, job.capture.credit, sounds}));
  FOURDVT_TRY(platform::writeFileAtomic(job.resultFolder() + "/" + kManifestFile, manifest));
  describeParts(job, character, report);
  FOURDVT_TRY(describeRefinement(job, report));
  return job.fromCameras() ? Status() : describeLayers(run, character, report);
}

Status writeReportFiles(const Job& job, const ReportInput& report) {
  // Pictures that are part of the character as well.
  for (const ReportPicture& picture : report.pictures) {
    const std::string of_character = job.resultFolder() + "/" + picture.file;
    if (!platform::fileBytes(of_character)) continue;
    FOURDVT_ASSIGN(const auto bytes, platform::readFile(of_character));
    FOURDVT_TRY(platform::writeFileAtomic(job.reportFolder() + "/" + picture.file, bytes));
  }
  return writeReport(job.reportFolder(), report);
}

}  // namespace fourdvt::bake
