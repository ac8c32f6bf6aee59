// SPDX-License-Identifier: Apache-2.0
#include "bake/run/stream_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bake/run/renditions.h"
#include "mattes/frame_reader.h"

namespace fourdvt::bake {
namespace {

// scale: residual step against the position step.
package::ResidualSteps stepsAt(double scale) {
  const auto rounded = [](double step) {
    return static_cast<uint32_t>(std::lround(std::min(step, double(package::kMaxResidualStep))));
  };
  return {rounded(kGridPerStep * scale), rounded(scale)};
}

}  // namespace

Result<std::unique_ptr<StreamReader>> StreamReader::create(BakeRun& run, const StreamPlan& plan) {
  std::unique_ptr<StreamReader> reader(new StreamReader(run, plan));
  if (plan.motion.reference_weights.empty()) return reader;
  StageClock::Span span(run.clock, Stage::Warp);
  const MeshTopology& topology = run.job.mesh.decoded.topology;
  FOURDVT_ASSIGN(reader->blend_, NonlinearBlend::create(topology, run.job.mesh.decoded.positions));
  return reader;
}

Result<PreparedFrame> StreamReader::read(uint32_t frame) {
  PreparedFrame out;
  for (size_t m = 0; m < sources_.size(); ++m) {
    FOURDVT_ASSIGN(auto member, readMember(m, frame));
    out.members.push_back(std::move(member));
  }
  if (!plan_.isClass()) {
    Positions pose = out.members[0].fresh->pose;
    capture::putInPlace(*plan_.motion.members[0].source, out.members[0].source_frame, pose);
    out.geometry = {{std::move(pose)}, {}, {plan_.motion.members[0].root[frame]}};
    return out;
  }
  FOURDVT_ASSIGN(out.geometry, blendGeometry(frame));
  return out;
}

Result<PreparedMember> StreamReader::readMember(size_t member, uint32_t frame) {
  PreparedMember out;
  out.source_frame = plan_.sourceFrame(member, frame);
  if (sources_[member].last == out.source_frame) return out;
  sources_[member].last = out.source_frame;
  if (plan_.isClass()) out.kept_layers = keptLayers(member, out.source_frame);
  if (!out.kept_layers.empty()) return out;
  FOURDVT_ASSIGN(out.fresh, readSource(member, out.source_frame));
  return out;
}

std::vector<Image> StreamReader::keptLayers(size_t member, uint32_t source_frame) const {
  StageClock::Span span(run_.clock, Stage::Decode);
  auto kept = run_.work.load<std::vector<Image>>(layersFile(plan_.motion.members[member].source->name, source_frame));
  return kept ? kept.take() : std::vector<Image>();
}

Result<SourceFrame> StreamReader::readSource(size_t member, uint32_t source_frame) {
  StageClock::Span span(run_.clock, Stage::Decode);
  Source& source = sources_[member];
  if (!source.reader || source_frame < source.next) {
    FOURDVT_ASSIGN(source.reader, mattes::FrameReader::open(run_.job.capture, *plan_.motion.members[member].source,
                                                            run_.environment.open_video, source_frame));
    source.next = source_frame;
  }
  for (; source.next < source_frame; ++source.next) FOURDVT_TRY(source.reader->next());
  FOURDVT_ASSIGN(auto frame, source.reader->next());
  ++source.next;
  SourceFrame out;
  out.pose = reordered(run_.job.mesh, frame.positions);
  for (size_t c = 0; c < run_.job.cameras.size(); ++c)
    out.crops.push_back(cropPicture(run_.job.cameras[c], out.pose, frame.pictures[c]));
  return out;
}

Result<FrameGeometry> StreamReader::blendGeometry(uint32_t frame) {
  StageClock::Span span(run_.clock, Stage::Warp);
  FrameGeometry out;
  const ReadPositions read = meshes_.function();
  for (const ClassMember& member : plan_.motion.members) {
    FOURDVT_ASSIGN(auto positions, memberPositions(member, frame, read));
    out.members.push_back(std::move(positions));
    out.root.push_back(member.root[frame]);
  }
  if (blend_) out.offsets = referenceOffsets(*blend_, plan_.motion, out.members);
  return out;
}

Result<Positions> MeshReader::read(const capture::CaptureSequence& sequence, uint32_t frame) {
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.sequence == &sequence && entry.frame == frame;
  });
  if (known != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, known);
    return entries_.front().positions;
  }
  FOURDVT_ASSIGN(auto positions, capture::readMeshFrameInPlace(job_->capture, sequence, frame));
  entries_.push_front({&sequence, frame, reordered(job_->mesh, positions)});
  if (entries_.size() > kKept) entries_.pop_back();
  return entries_.front().positions;
}

ChunkBuilder::ChunkBuilder(const Job& job, const StreamPlan& plan)
    : origin_(job.bounds.min), step_m_(gridStep_m(job.options)) {
  empty_.vertex_count = job.mesh.decoded.topology.vertex_count;
  empty_.face_count = job.mesh.decoded.topology.faceCount();
  empty_.layer_count = static_cast<uint32_t>(job.options.layers);
  empty_.member_count = static_cast<uint32_t>(plan.motion.members.size());
  empty_.reference_count = static_cast<uint32_t>(plan.motion.reference_weights.size());
  frames_ = empty_;
}

void ChunkBuilder::quantise(const Positions& positions, const glm::dvec3& origin, std::vector<glm::ivec3>& out) const {
  for (const glm::vec3& p : positions) out.emplace_back(gridPlace(p, origin, step_m_));
}

void ChunkBuilder::add(const FrameGeometry& geometry, const std::vector<uint8_t>& labels) {
  for (const Positions& member : geometry.members) quantise(member, origin_, frames_.positions);
  for (const Positions& offset : geometry.offsets) quantise(offset, glm::dvec3(0), frames_.offsets);
  frames_.labels.insert(frames_.labels.end(), labels.begin(), labels.end());
  frames_.root.insert(frames_.root.end(), geometry.root.begin(), geometry.root.end());
  ++frames_.frame_count;
}

package::ChunkFrames ChunkBuilder::finish() { return std::exchange(frames_, empty_); }

Status saveChunks(const BakeRun& run, const StreamPlan& plan, uint32_t gop, const package::ChunkFrames& frames,
                  const package::ChunkMesh& mesh) {
  const BakeOptions& o = run.job.options;
  if (hasCoarseGeometry(o)) {
    FOURDVT_ASSIGN(const auto coarse,
                   package::encodeChunk(frames, mesh, stepsAt(*o.coarse_step_m / *o.position_step_m)));
    FOURDVT_TRY(run.work.save(chunkFile(plan.name, gop, Precision::Coarse), coarse));
  }
  FOURDVT_ASSIGN(const auto chunk, package::encodeChunk(frames, mesh, stepsAt(1)));
  return run.work.save(chunkFile(plan.name, gop), chunk);
}

}  // namespace fourdvt::bake
