// SPDX-License-Identifier: Apache-2.0
#include "bake/run/stream_reader.h"

namespace fourdvt::bake {

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
    out.geometry = {{out.members[0].fresh->pose}, {}, {plan_.motion.members[0].root[frame]}};
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
  auto kept = run_.work.loadLayers(plan_.motion.members[member].source->name, source_frame);
  return kept ? kept.take() : std::vector<Image>();
}

Result<SourceFrame> StreamReader::readSource(size_t member, uint32_t source_frame) {
  StageClock::Span span(run_.clock, Stage::Decode);
  Source& source = sources_[member];
  if (!source.reader || source_frame < source.next) {
    FOURDVT_ASSIGN(source.reader, capture::FrameReader::open(run_.job.capture, *plan_.motion.members[member].source,
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

}  // namespace fourdvt::bake
