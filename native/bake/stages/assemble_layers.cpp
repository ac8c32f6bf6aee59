// SPDX-License-Identifier: Apache-2.0
#include "bake/run/renditions.h"
#include "bake/stages/assembly.h"
#include "base/bytes.h"
#include "base/hash.h"
#include "motion/blend.h"
#include "platform/files.h"
#include "render/plain_figure.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kTexture = "texture.jpg";  // without its hash
constexpr const char* kTiles = "report_tiles.jpg";

struct LayeredChunkBytes {
  uint32_t total = 0, positions = 0, labels = 0, offsets = 0, alignment = 0;
  uint64_t hash = 0;
};

// Sizes of a chunk's parts, whose lengths are at its beginning (native/package/FORMAT.md).
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

// Number of the lowest renditions that have fewer texels than the highest.
uint32_t smallerRenditions(const package::Sequence& s) {
  const auto width = [](const package::Rendition& r) { return r.layers[0].width; };
  uint32_t count = 0;
  while (width(s.renditions[count]) < width(s.renditions.back())) ++count;
  return count;
}

void addCoarseChunks(const std::vector<LayeredChunkBytes>& chunk_bytes, package::StreamIndex& index) {
  index.coarse_chunks = index.chunks;
  for (size_t g = 0; g < chunk_bytes.size(); ++g) {
    index.coarse_chunks[g].bytes = chunk_bytes[g].total;
    index.coarse_chunks[g].hash = chunk_bytes[g].hash;
  }
}

package::StreamIndex layeredIndex(const Job& job, const StreamPlan& plan,
                                  const std::vector<LayeredChunkBytes>& chunk_bytes,
                                  std::vector<package::SampleTable> tables) {
  package::StreamIndex index = streamIndex(job, plan, std::move(tables));
  index.vertex_count = job.mesh.decoded.topology.vertex_count;
  index.face_count = job.mesh.decoded.topology.faceCount();
  index.layer_count = static_cast<uint32_t>(job.options.layers);
  index.member_count = static_cast<uint32_t>(plan.motion.members.size());
  index.reference_count = static_cast<uint32_t>(plan.motion.reference_weights.size());
  if (isAligned(job, plan)) {
    index.alignment_count = index.member_count - 1;
    index.alignment_step_m = static_cast<float>(*job.options.classes.alignment_step_m);
  }
  for (uint32_t g = 0; g < chunk_bytes.size(); ++g) addChunk(plan, g, chunk_bytes[g].total, chunk_bytes[g].hash, index);
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

// Renders the still from the page's initial view, as RGBA with straight alpha. layout: of the still's picture.
// `positions` are in the decoded mesh's order.
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

}  // namespace

Status packLayers(const BakeRun& run, const StreamPlan& plan, package::Character& character, ReportInput& report) {
  const Job& job = run.job;
  package::Sequence s = describeStream(plan);
  FOURDVT_ASSIGN(const auto chunk_bytes, measureChunks(run, plan, Precision::Fine));
  FOURDVT_ASSIGN(auto tables, packVideos(plan, run, s));
  package::StreamIndex index = layeredIndex(job, plan, chunk_bytes, std::move(tables));
  if (hasCoarseGeometry(job.options)) s.coarse_renditions = smallerRenditions(s);
  if (s.coarse_renditions > 0) {
    FOURDVT_ASSIGN(const auto coarse_bytes, measureChunks(run, plan, Precision::Coarse));
    addCoarseChunks(coarse_bytes, index);
    character.version = package::kCoarseFormatVersion;
  }
  FOURDVT_TRY(writeStream(std::move(index), run, plan, s));
  ReportSequence& r = report.sequences.emplace_back(reportSequence(s, plan));
  for (const LayeredChunkBytes& bytes : chunk_bytes) {
    r.geometry_bytes += bytes.positions;
    r.offset_bytes += bytes.offsets;
    r.alignment_bytes += bytes.alignment;
    r.label_bytes += bytes.labels;
    r.index_bytes += bytes.total - bytes.positions - bytes.offsets - bytes.alignment - bytes.labels;
  }
  character.sequences.push_back(std::move(s));
  return {};
}

Result<std::string> drawLayeredStills(const BakeRun& run, const package::Character& character) {
  const Job& job = run.job;
  FOURDVT_ASSIGN(auto still, run.work.load<StillArtefact>(kStillFile));
  FOURDVT_TRY(platform::writeFileAtomic(job.reportFolder() + "/" + kTiles, still.tile_jpeg));
  FOURDVT_ASSIGN(auto positions, capture::readMeshFrameInPlace(job.capture, job.capture.sequences[0], 0));
  FOURDVT_ASSIGN(auto poster,
                 renderPoster(run.device(), character, job.mesh.decoded, describeStream(job.streams[0]).renditions[0],
                              still, reordered(job.mesh, positions)));
  FOURDVT_TRY(writePoster(job, poster));
  return writeNamed(job.resultFolder(), kTexture, still.texture_jpeg);
}

Status describeLayers(const BakeRun& run, const package::Character& character, ReportInput& report) {
  const Job& job = run.job;
  const std::string first = job.streams[0].name + ", frame 0";
  report.pictures = {{kPosterFile, "The character, " + first + ", as the page shows it first."},
                     {kTiles, "The video picture of " + first + ": all layers and the barcode."}};
  for (const StreamPlan& plan : job.streams) {
    if (!plan.isClass()) continue;
    report.figures.classes[plan.name] = figuresOf(job, plan, *character.find(plan.name));
    FOURDVT_ASSIGN(const auto artefact, run.work.load<GopArtefact>(gopFile(plan.name, 0)));
    FOURDVT_TRY(reportPicture(
        job, plan, artefact.picture_jpeg,
        "the layers of " + std::to_string(plan.motion.members.size()) + " members and the barcode.", report));
  }
  return {};
}

}  // namespace fourdvt::bake
