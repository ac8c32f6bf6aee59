// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/stream_reader.h"

namespace fourdvt::bake {

Result<std::unique_ptr<StreamReader>> StreamReader::create(const Job& job, const StreamPlan& plan,
                                                           const OpenVideo& open_video, StageClock& clock) {
  std::unique_ptr<StreamReader> reader(new StreamReader(job, plan, open_video, clock));
  if (plan.motion.reference_weights.empty()) return reader;
  StageClock::Span span(clock, "warp");
  auto blend = NonlinearBlend::create(job.mesh.decoded.topology, job.mesh.decoded.positions);
  if (!blend) return blend.error();
  reader->blend_ = blend.take();
  return reader;
}

Result<PreparedFrame> StreamReader::read(uint32_t frame) {
  PreparedFrame out;
  for (size_t m = 0; m < sources_.size(); ++m) {
    auto member = readMember(m, frame);
    if (!member) return member.error();
    out.members.push_back(member.take());
  }
  if (!plan_.isClass()) {
    out.geometry = {{out.members[0].fresh->pose}, {}, {plan_.motion.members[0].root[frame]}};
    return out;
  }
  auto geometry = blendGeometry(frame);
  if (!geometry) return geometry.error();
  out.geometry = geometry.take();
  return out;
}

Result<PreparedMember> StreamReader::readMember(size_t member, uint32_t frame) {
  PreparedMember out;
  out.source_frame = plan_.sourceFrame(member, frame);
  if (sources_[member].last == out.source_frame) return out;
  auto source = readSource(member, out.source_frame);
  if (!source) return source.error();
  out.fresh = source.take();
  return out;
}

Result<SourceFrame> StreamReader::readSource(size_t member, uint32_t source_frame) {
  StageClock::Span span(clock_, "decode");
  Source& source = sources_[member];
  if (!source.reader || source_frame < source.next) {
    auto opened =
        capture::FrameReader::open(job_.capture, *plan_.motion.members[member].source, open_video_, source_frame);
    if (!opened) return opened.error();
    source.reader = opened.take();
    source.next = source_frame;
  }
  for (; source.next < source_frame; ++source.next)
    if (auto passed = source.reader->next(); !passed) return passed.error();
  auto frame = source.reader->next();
  if (!frame) return frame.error();
  ++source.next;
  source.last = source_frame;
  SourceFrame out;
  out.pose = reordered(job_.mesh, frame.value().positions);
  for (size_t c = 0; c < job_.cameras.size(); ++c)
    out.crops.push_back(cropPicture(job_.cameras[c], out.pose, frame.value().pictures[c]));
  return out;
}

Result<FrameGeometry> StreamReader::blendGeometry(uint32_t frame) {
  StageClock::Span span(clock_, "warp");
  FrameGeometry out;
  const ReadPositions read = meshes_.function();
  for (const ClassMember& member : plan_.motion.members) {
    auto positions = memberPositions(member, frame, read);
    if (!positions) return positions.error();
    out.members.push_back(positions.take());
    out.root.push_back(member.root[frame]);
  }
  if (blend_) out.offsets = referenceOffsets(*blend_, plan_.motion, out.members);
  return out;
}

}  // namespace fourdvt::bake
