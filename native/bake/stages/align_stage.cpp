// SPDX-License-Identifier: Apache-2.0

#include "bake/align/surface_alignment.h"
#include "bake/run/character_files.h"
#include "bake/run/stream_reader.h"
#include "bake/stages/stages.h"
#include "package/chunk_mesh.h"
#include "platform/ffmpeg_video.h"
#include "store/record_file.h"

namespace fourdvt::store {

void fields(Archive& a, bake::AlignedFrame& f) { a(f.displacement_m, f.confidence, f.detail_correlation); }

}  // namespace fourdvt::store

namespace fourdvt::bake {
namespace {

double alignWork(const StreamPlan& plan) {
  return infoOf(Stage::Align).work_s * plan.frameCount() * double(plan.motion.members.size() - 1);
}

// Aligns one class, phase by phase.
class ClassAligner {
 public:
  ClassAligner(BakeRun& run, const StreamPlan& plan, StageProgress& progress)
      : run_(run), job_(run.job), plan_(plan), progress_(progress) {}

  // [phase], smoothed over the whole motion.
  Result<std::vector<AlignedFrame>> run();
  // The records of one GOP, complete.
  Result<store::RecordFile> finished(uint32_t gop);

 private:
  Status open();
  uint32_t framesOf(uint32_t gop) const { return plan_.gopEnd(gop) - plan_.gop_first_frames[gop]; }
  // Records of the GOP's phases, which depend on no other GOP.
  Result<store::RecordFile> recordsOf(uint32_t gop) const;
  Status alignGop(uint32_t gop, store::RecordFile& file);
  Status alignPicture(const package::ChunkFrames& frames, uint32_t gop, uint32_t row, const I420View& picture,
                      store::RecordFile& file);
  Positions middle(const package::ChunkFrames& frames, uint32_t row) const;
  size_t vertices() const { return job_.mesh.decoded.topology.vertex_count * (plan_.motion.members.size() - 1); }
  size_t recordBytes() const {
    return store::bytesOf(AlignedFrame{std::vector<glm::vec2>(vertices()), std::vector<float>(vertices())}).size();
  }

  BakeRun& run_;
  const Job& job_;
  const StreamPlan& plan_;
  StageProgress& progress_;
  package::Character character_;  // borrowed by the aligner
  std::unique_ptr<SurfaceAligner> aligner_;
  std::optional<NonlinearBlend> blend_;
  std::optional<render::CharacterModel> model_;
  std::optional<render::Appearance> appearance_;
  std::optional<render::PictureTextures> picture_;
};

Result<std::vector<AlignedFrame>> ClassAligner::run() {
  std::vector<AlignedFrame> frames;
  for (uint32_t g = 0; g < plan_.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(auto file, finished(g));
    StageClock::Span span(run_.clock, Stage::Align);
    for (uint32_t f = 0; f < framesOf(g); ++f) {
      FOURDVT_ASSIGN(auto record, file.read(f));
      if (!store::readBytes(record, frames.emplace_back())) return store::damagedFile(run_.work.path());
    }
  }
  StageClock::Span span(run_.clock, Stage::Align);
  steadyAlignment(frames, plan_.motion.loop);
  return frames;
}

Result<store::RecordFile> ClassAligner::finished(uint32_t gop) {
  FOURDVT_ASSIGN(auto file, recordsOf(gop));
  if (file.count() < framesOf(gop)) {
    if (!aligner_) FOURDVT_TRY(open());
    FOURDVT_TRY(alignGop(gop, file));
  }
  FOURDVT_TRY(file.finish());
  return file;
}

Status ClassAligner::open() {
  StageClock::Span span(run_.clock, Stage::Align);
  const package::BaseMesh& mesh = job_.mesh.decoded;
  gpu::Device& device = run_.device();
  character_ = describeCharacter(job_);
  character_.sequences.push_back(describeStream(plan_));
  AlignmentOptions options;
  options.gutter_texels = job_.options.gutter_texels;
  options.jobs = job_.options.jobs;
  options.max_displacement_m *= job_.length_scale;
  FOURDVT_ASSIGN(aligner_, SurfaceAligner::create(device, character_, mesh, options));
  FOURDVT_ASSIGN(blend_, NonlinearBlend::create(mesh.topology, mesh.positions));
  FOURDVT_ASSIGN(model_, render::CharacterModel::create(device, character_, mesh));
  FOURDVT_ASSIGN(appearance_,
                 render::Appearance::create(device, *model_, static_cast<int>(plan_.motion.members.size())));
  appearance_->setLayout(character_.sequences.back().renditions.front());
  FOURDVT_ASSIGN(picture_, render::createPicture(device, plan_.layout().width, plan_.layout().height,
                                                 render::PictureTextures::Kind::I420));
  return {};
}

Result<store::RecordFile> ClassAligner::recordsOf(uint32_t gop) const {
  return store::RecordFile::resume(run_.work.pathOf(plan_.name + "." + std::to_string(gop) + ".alignment"),
                                   recordBytes(), framesOf(gop), run_.environment.writer);
}

Status ClassAligner::alignGop(uint32_t gop, store::RecordFile& file) {
  FOURDVT_ASSIGN(const GopArtefact artefact, run_.work.load<GopArtefact>(gopFile(plan_.name, gop)));
  Status aligned;
  auto decoder =
      platform::SampleDecoder::create(encode::infoOf(plan_.encode().codec).kind, artefact.videos[0].parameter_sets,
                                      [&](const I420View& view, int64_t frame) {
                                        const uint32_t row = static_cast<uint32_t>(frame);
                                        if (aligned.ok() && row == file.count())
                                          aligned = alignPicture(artefact.frames, gop, row, view, file);
                                      });
  if (!decoder) return decoder.error();
  for (const encode::EncodedPacket& packet : artefact.videos[0].packets) {
    FOURDVT_TRY(decoder.value()->decode(packet.bytes, packet.frame, packet.key));
    FOURDVT_TRY(aligned);
  }
  FOURDVT_TRY(decoder.value()->flush());
  FOURDVT_TRY(aligned);
  if (file.count() == framesOf(gop)) return {};
  return Error{ErrorId::Internal,
               run_.work.path() + ": a GOP of " + plan_.name + " decodes to fewer pictures than frames"};
}

Status ClassAligner::alignPicture(const package::ChunkFrames& frames, uint32_t gop, uint32_t row, const I420View& view,
                                  store::RecordFile& file) {
  FOURDVT_TRY(run_.checkStop());
  StageClock::Span span(run_.clock, Stage::Align);
  gpu::Device& device = run_.device();
  render::uploadPicture(device, *picture_, view);
  const size_t labels = size_t(frames.member_count) * frames.layer_count * frames.face_count;
  appearance_->setFrame(device, *model_, {std::span(frames.labels).subspan(row * labels, labels), {}});
  FOURDVT_ASSIGN(auto aligned, aligner_->align(middle(frames, row), *appearance_, *picture_));
  FOURDVT_TRY(file.append(store::bytesOf(aligned)));
  const uint32_t done = plan_.gop_first_frames[gop] + file.count();
  progress_.done(double(done) / plan_.frameCount(),
                 "align " + plan_.name + " " + std::to_string(done) + "/" + std::to_string(plan_.frameCount()));
  return {};
}

Positions ClassAligner::middle(const package::ChunkFrames& frames, uint32_t row) const {
  std::vector<Positions> members(frames.member_count);
  const glm::ivec3* q = &frames.positions[size_t(row) * frames.member_count * frames.vertex_count];
  for (Positions& member : members)
    for (uint32_t v = 0; v < frames.vertex_count; ++v, ++q)
      member.push_back(job_.bounds.min + float(gridStep_m(job_.options)) * glm::vec3(*q));
  return blend_->blend(members, std::vector<float>(members.size(), 1.0f / members.size()));
}

float meanCorrelation(const std::vector<AlignedFrame>& frames) {
  double sum = 0;
  for (const AlignedFrame& frame : frames) sum += frame.detail_correlation;
  return static_cast<float>(sum / double(frames.size()));
}

// Sets the alignment of `frames`, one entry per frame.
void addAlignment(std::span<const AlignedFrame> aligned, double step_m, package::ChunkFrames& frames) {
  frames.alignment_count = frames.member_count - 1;
  const double step = double(float(step_m));
  for (const AlignedFrame& frame : aligned)
    for (const glm::vec2& d : frame.displacement_m) frames.alignment.emplace_back(glm::round(glm::dvec2(d) / step));
}

// aligned: [phase], or none.
Status codeChunks(const BakeRun& run, const StreamPlan& plan, const std::vector<AlignedFrame>& aligned,
                  const package::ChunkMesh& mesh) {
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(auto artefact, run.work.load<GopArtefact>(gopFile(plan.name, g)));
    package::ChunkFrames& frames = artefact.frames;
    if (!aligned.empty())
      addAlignment(std::span(aligned).subspan(plan.gop_first_frames[g], frames.frame_count),
                   *run.job.options.classes.alignment_step_m, frames);
    FOURDVT_TRY(saveChunks(run, plan, g, frames, mesh));
  }
  return {};
}

bool hasChunks(const StreamPlan& plan, const WorkFolder& work) {
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g)
    if (!work.has(chunkFile(plan.name, g))) return false;
  return true;
}

}  // namespace

Status alignGop(BakeRun& run, const StreamPlan& plan, uint32_t gop) {
  StageProgress progress(run.progress, 0);
  FOURDVT_ASSIGN([[maybe_unused]] const auto file, ClassAligner(run, plan, progress).finished(gop));
  return {};
}

Status alignClass(BakeRun& run, StreamPlan& plan) {
  const bool aligns = run.job.options.classes.align;
  StageProgress progress(run.progress, aligns ? alignWork(plan) : 0);
  std::vector<AlignedFrame> aligned;
  if (aligns) {
    FOURDVT_ASSIGN(aligned, ClassAligner(run, plan, progress).run());
    plan.detail_correlation = meanCorrelation(aligned);
  }
  if (hasChunks(plan, run.work)) return {};
  StageClock::Span span(run.clock, Stage::Geometry);
  return codeChunks(run, plan, aligned, package::makeChunkMesh(run.job.mesh.decoded));
}

Status alignClasses(BakeRun& run) {
  for (StreamPlan& plan : run.job.streams)
    if (plan.isClass()) FOURDVT_TRY(alignClass(run, plan));
  return {};
}

}  // namespace fourdvt::bake
