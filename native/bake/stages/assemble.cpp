// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/assemble.h"

#include "bake/run/character_files.h"
#include "bake/run/renditions.h"
#include "bake/stages/sound_stage.h"
#include "bake/stages/start_stage.h"
#include "base/bytes.h"
#include "base/hash.h"
#include "motion/parameter_space.h"
#include "package/writer.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "render/plain_figure.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kTexture = "texture.jpg";  // before its hash, like the graph
constexpr const char* kTiles = "report_tiles.jpg";
constexpr const char* kGraph = "motion.bin";

struct LayeredChunkBytes {
  uint32_t total = 0, positions = 0, labels = 0, offsets = 0, alignment = 0;
  uint64_t hash = 0;
};

// A chunk begins with the lengths of its parts (native/package/FORMAT.md).
LayeredChunkBytes measure(const StreamPlan& plan, const std::vector<uint8_t>& chunk, bool aligned) {
  ByteReader lengths(chunk);
  LayeredChunkBytes bytes;
  bytes.total = static_cast<uint32_t>(chunk.size());
  bytes.hash = fnv1a(chunk);
  const size_t members = plan.motion.members.size();
  for (size_t m = 0; m < members; ++m) {
    bytes.positions += lengths.u32();
    bytes.labels += lengths.u32();
  }
  for (size_t r = 0; r < plan.motion.reference_weights.size(); ++r) bytes.offsets += lengths.u32();
  for (size_t a = 1; aligned && a < members; ++a) bytes.alignment += lengths.u32();
  return bytes;
}

bool isAligned(const Job& job, const StreamPlan& plan) { return plan.isClass() && job.options.classes.align; }

struct PackedSequence {
  package::Sequence manifest;
  ReportSequence report;
};

// How many of the lowest renditions have fewer texels than the highest.
uint32_t smallerRenditions(const package::Sequence& s) {
  const auto width = [](const package::Rendition& r) { return r.layers[0].width; };
  uint32_t count = 0;
  while (width(s.renditions[count]) < width(s.renditions.back())) ++count;
  return count;
}

void addCoarseChunks(const Job& job, const std::vector<LayeredChunkBytes>& chunk_bytes, package::StreamIndex& index) {
  index.coarse_step_m = static_cast<float>(*job.options.coarse_step_m);
  index.coarse_chunks = index.chunks;
  for (size_t g = 0; g < chunk_bytes.size(); ++g) {
    index.coarse_chunks[g].bytes = chunk_bytes[g].total;
    index.coarse_chunks[g].hash = chunk_bytes[g].hash;
  }
}

package::StreamIndex makeIndex(const Job& job, const StreamPlan& plan,
                               const std::vector<LayeredChunkBytes>& chunk_bytes,
                               std::vector<package::SampleTable> tables) {
  package::StreamIndex index;
  index.frame_count = plan.frameCount();
  index.vertex_count = job.mesh.decoded.topology.vertex_count;
  index.face_count = job.mesh.decoded.topology.faceCount();
  index.layer_count = static_cast<uint32_t>(job.options.layers);
  index.member_count = static_cast<uint32_t>(plan.motion.members.size());
  index.reference_count = static_cast<uint32_t>(plan.motion.reference_weights.size());
  if (isAligned(job, plan)) {
    index.alignment_count = index.member_count - 1;
    index.alignment_step_m = static_cast<float>(*job.options.classes.alignment_step_m);
  }
  index.position_origin = job.bounds.min;
  index.position_step_m = static_cast<float>(*job.options.position_step_m);
  index.renditions = std::move(tables);
  for (size_t g = 0; g < chunk_bytes.size(); ++g) {
    const uint32_t first = plan.gop_first_frames[g];
    index.chunks.push_back({first, plan.gopEnd(g) - first, 0, chunk_bytes[g].total, chunk_bytes[g].hash});
  }
  return index;
}

Result<std::vector<LayeredChunkBytes>> measureChunks(const BakeRun& run, const StreamPlan& plan, Precision precision) {
  std::vector<LayeredChunkBytes> bytes;
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(auto chunk, run.work.load<store::Bytes>(chunkFile(plan.name, g, precision)));
    bytes.push_back(measure(plan, chunk, isAligned(run.job, plan)));
  }
  return bytes;
}

ReportSequence reportSequence(const package::Sequence& s, const std::vector<LayeredChunkBytes>& chunk_bytes) {
  ReportSequence r;
  r.name = s.name;
  r.frames = s.frame_count;
  r.gops = static_cast<uint32_t>(chunk_bytes.size());
  r.fps = s.fps;
  r.loop = s.loop;
  r.members = static_cast<uint32_t>(s.members.size());
  describeRenditions(s, r);
  r.index_bytes = s.stream_header_bytes;
  for (const LayeredChunkBytes& bytes : chunk_bytes) {
    r.geometry_bytes += bytes.positions;
    r.offset_bytes += bytes.offsets;
    r.alignment_bytes += bytes.alignment;
    r.label_bytes += bytes.labels;
    r.index_bytes += bytes.total - bytes.positions - bytes.offsets - bytes.alignment - bytes.labels;
  }
  return r;
}

Result<PackedSequence> packSequence(const BakeRun& run, const StreamPlan& plan) {
  const Job& job = run.job;
  PackedSequence out;
  package::Sequence& s = out.manifest;
  s = describeStream(plan);
  FOURDVT_ASSIGN(auto chunk_bytes, measureChunks(run, plan, Precision::Fine));
  FOURDVT_ASSIGN(auto tables, packVideos(plan, run, s));
  package::StreamIndex index = makeIndex(job, plan, chunk_bytes, std::move(tables));
  if (hasCoarseGeometry(job.options)) s.coarse_renditions = smallerRenditions(s);
  if (s.coarse_renditions > 0) {
    FOURDVT_ASSIGN(const auto coarse_bytes, measureChunks(run, plan, Precision::Coarse));
    addCoarseChunks(job, coarse_bytes, index);
  }
  FOURDVT_TRY(writeStream(std::move(index), run, plan, s));
  out.report = reportSequence(s, chunk_bytes);
  return out;
}

// Renders the still from the view that the page starts with, as RGBA with straight alpha. layout: of the still's
// picture. `positions` are in the decoded mesh's order.
Result<Image> renderPoster(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh,
                           const package::Rendition& layout, const StillArtefact& still, const Positions& positions) {
  FOURDVT_ASSIGN(auto figure, render::PlainFigure::create(device, character, mesh));
  const I420View view = still.picture.view();
  FOURDVT_ASSIGN(auto picture,
                 render::createPicture(device, view.width, view.height, render::PictureTextures::Kind::I420));
  FOURDVT_ASSIGN(auto recipe, render::Recipe::create(device));
  gpu::TargetDesc desc;
  desc.width = kPosterWidth;
  desc.height = kPosterHeight;
  desc.label = "poster";
  FOURDVT_ASSIGN(auto target, gpu::makeTarget(device, desc));
  render::uploadPicture(device, picture, view);
  figure.setLayout(layout);
  figure.setFrame(device, positions, still.labels);
  const OrbitView orbit = defaultOrbit(character.bounds, double(kPosterWidth) / kPosterHeight);
  const PinholeCamera camera = cameraFromOrbit(orbit, kPosterWidth, kPosterHeight);
  const auto scale = static_cast<float>(character.length_scale);
  FOURDVT_TRY(figure.draw(*recipe, picture, render::viewFromCamera(camera, {scale, scale}), {}, target.id()));
  Image image(kPosterWidth, kPosterHeight, 4);
  FOURDVT_TRY(device.readPixels(target.id(), gpu::PixelFormat::RGBA8, {.width = kPosterWidth, .height = kPosterHeight},
                                image.pixels.data()));
  unpremultiply(image);
  return image;
}

// Returns the texture's name.
Result<std::string> writeStills(const BakeRun& run, const package::Character& character) {
  const Job& job = run.job;
  const std::string folder = job.resultFolder() + "/";
  FOURDVT_ASSIGN(auto still, run.work.load<StillArtefact>(kStillFile));
  FOURDVT_TRY(platform::writeFileAtomic(job.reportFolder() + "/" + kTiles, still.tile_jpeg));
  FOURDVT_ASSIGN(auto positions, capture::readMeshFrame(job.capture, job.capture.sequences[0], 0));
  FOURDVT_ASSIGN(auto poster,
                 renderPoster(run.device(), character, job.mesh.decoded, describeStream(job.streams[0]).renditions[0],
                              still, reordered(job.mesh, positions)));
  FOURDVT_ASSIGN(auto webp, platform::encodeImage(poster, ".webp", 85));
  FOURDVT_TRY(platform::writeFileAtomic(folder + kPosterFile, webp));
  return writeNamed(job.resultFolder(), kTexture, still.texture_jpeg);
}

void describe(const Job& job, const package::Character& character, const std::string& texture, ReportInput& report) {
  report.picture_width = job.layout.width;
  report.picture_height = job.layout.height;
  const std::string first = job.streams[0].name + ", frame 0";
  report.pictures = {{kPosterFile, "The character, " + first + ", as the page shows it first."},
                     {kTiles, "The video picture of " + first + ": all layers and the barcode."}};
  describeCommon(job, character, report);
  report.figures.bytes_by_part[texture] = platform::fileBytes(job.resultFolder() + "/" + texture);
}

ClassSummary figuresOf(const Job& job, const StreamPlan& plan, const package::Sequence& sequence) {
  ClassSummary figures;
  for (const package::Member& member : sequence.members) figures.members.push_back(member.name);
  for (size_t p = 0; p < sequence.space.names.size(); ++p) {
    const motion::Range range = motion::parameterRange(sequence, p);
    figures.parameters.push_back({sequence.space.names[p], range.min, range.max});
  }
  figures.references = sequence.reference_count;
  figures.linear_error_m = plan.motion.linear_error_m;
  figures.hybrid_error_m = plan.motion.hybrid_error_m;
  figures.aligned = isAligned(job, plan);
  return figures;
}

// Adds the summary and a picture of every class to the report.
Status describeClasses(const BakeRun& run, const package::Character& character, ReportInput& report) {
  const Job& job = run.job;
  for (const StreamPlan& plan : job.streams) {
    if (!plan.isClass()) continue;
    report.figures.classes[plan.name] = figuresOf(job, plan, *character.find(plan.name));
    FOURDVT_ASSIGN(auto artefact, run.work.load<GopArtefact>(gopFile(plan.name, 0)));
    const std::string file = "report_" + plan.name + ".jpg";
    FOURDVT_TRY(platform::writeFileAtomic(job.reportFolder() + "/" + file, artefact.picture_jpeg));
    report.pictures.push_back({file, "The video picture of " + plan.name + ", frame 0: the layers of " +
                                         std::to_string(plan.motion.members.size()) + " members and the barcode."});
  }
  return {};
}

Status writeGraph(const Job& job, const std::vector<uint8_t>& graph, package::Character& character,
                  ReportInput& report) {
  if (graph.empty()) return {};
  FOURDVT_ASSIGN(character.graph_uri, writeNamed(job.resultFolder(), kGraph, graph));
  character.graph_bytes = graph.size();
  character.graph_hash = fnv1a(graph);
  report.figures.bytes_by_part[character.graph_uri] = graph.size();
  return {};
}

}  // namespace

void describeRenditions(const package::Sequence& sequence, ReportSequence& report) {
  for (size_t r = 0; r < sequence.renditions.size(); ++r) {
    const package::Rendition& rendition = sequence.renditions[r];
    report.renditions.push_back({rendition.video_uri, rendition.codec, rendition.width, rendition.height,
                                 rendition.video_bytes, sequence.geometryBytes(static_cast<uint32_t>(r))});
  }
  report.video_bytes = sequence.renditions.back().video_bytes;
}

void describeCommon(const Job& job, const package::Character& character, ReportInput& report) {
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

Status makeResultFolders(const Job& job) {
  for (const std::string& folder : {job.resultFolder(), job.reportFolder()}) {
    platform::removeFolder(folder);
    FOURDVT_TRY(platform::makeFolder(folder));
  }
  return {};
}

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

Status assemble(BakeRun& run, const std::vector<uint8_t>& graph, const std::optional<BakedRoom>& room,
                ReportInput& report) {
  StageClock::Span span(run.clock, Stage::Assemble);
  const Job& job = run.job;
  FOURDVT_TRY(makeResultFolders(job));
  package::Character character = describeCharacter(job);
  for (const StreamPlan& plan : job.streams) {
    FOURDVT_ASSIGN(auto packed, packSequence(run, plan));
    if (packed.manifest.coarse_renditions > 0) character.version = package::kCoarseFormatVersion;
    character.sequences.push_back(std::move(packed.manifest));
    report.sequences.push_back(std::move(packed.report));
  }
  FOURDVT_ASSIGN(character.mesh_uri, writeNamed(job.resultFolder(), kMeshFile, job.mesh.bytes));
  FOURDVT_ASSIGN(const std::string texture, writeStills(run, character));
  FOURDVT_TRY(writeGraph(job, graph, character, report));
  FOURDVT_TRY(writeRoom(job, room, character, report));
  FOURDVT_TRY(writeStart(run, character, report));
  FOURDVT_ASSIGN(const auto sounds, writeSounds(run, report));
  FOURDVT_ASSIGN(auto manifest,
                 package::writeManifest({character, &job.mesh, texture, kGenerator, job.capture.credit, sounds}));
  FOURDVT_TRY(platform::writeFileAtomic(job.resultFolder() + "/" + kManifestFile, manifest));
  describe(job, character, texture, report);
  FOURDVT_TRY(describeRefinement(job, report));
  return describeClasses(run, character, report);
}

Status writeReportFiles(const Job& job, const ReportInput& report) {
  // Pictures that players have, too.
  for (const ReportPicture& picture : report.pictures) {
    const std::string of_character = job.resultFolder() + "/" + picture.file;
    if (!platform::fileBytes(of_character)) continue;
    FOURDVT_ASSIGN(const auto bytes, platform::readFile(of_character));
    FOURDVT_TRY(platform::writeFileAtomic(job.reportFolder() + "/" + picture.file, bytes));
  }
  return writeReport(job.reportFolder(), report);
}

}  // namespace fourdvt::bake
