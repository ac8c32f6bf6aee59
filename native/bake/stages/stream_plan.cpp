// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "bake/run/renditions.h"
#include "bake/run/stream_reader.h"
#include "bake/stages/stages.h"

namespace fourdvt::bake {
namespace {

Error interrupted() { return {ErrorId::Interrupted, "stopped; nothing was written"}; }

Result<ClassPlan> planSequence(const Job& job, const capture::CaptureSequence& source, const ReadPositions& read) {
  ClassPlan plan;
  std::string note;
  FOURDVT_ASSIGN(auto track, rootTrack(job.capture, source, read, &note));
  if (!note.empty()) plan.notes.push_back(note);
  plan.frame_count = source.frame_count;
  plan.fps = job.capture.fps;
  plan.loop = source.loop;
  ClassMember member;
  member.source = &source;
  for (uint32_t f = 0; f < source.frame_count; ++f) member.source_frame.push_back(f);
  member.root.assign(track.begin(), track.end() - 1);
  plan.members.push_back(std::move(member));
  package::Member manifest;
  manifest.name = source.name;
  manifest.duration_s = source.frame_count / job.capture.fps;
  manifest.travel = track.back();
  plan.manifest.push_back(std::move(manifest));
  return plan;
}

void addStream(Job& job, const std::string& name, ClassPlan motion) {
  StreamPlan stream;
  stream.name = name;
  const BakeOptions& o = job.options;
  RenditionPlan& highest = stream.renditions.emplace_back();
  highest.layout = encode::makeTileLayout(o.layers, o.texture, o.equal_layers, static_cast<int>(motion.members.size()));
  highest.encode = job.encode;
  highest.encode.width = highest.layout.width;
  highest.encode.height = highest.layout.height;
  highest.encode.fps = motion.fps;
  stream.gop_first_frames = encode::planGops(motion.frame_count, o.gop);
  stream.motion = std::move(motion);
  addLowerRenditions(o, stream);
  job.streams.push_back(std::move(stream));
}

// Grows the bounds by interpolated meshes, which may overshoot the captured frames.
Status growBounds(Job& job, const ClassPlan& plan, const ReadPositions& read) {
  for (const ClassMember& member : plan.members) {
    for (uint32_t f = 0; f < plan.frame_count; ++f) {
      FOURDVT_ASSIGN(auto positions, memberPositions(member, f, read));
      job.bounds.grow(positions);
    }
  }
  return {};
}

Status planClasses(BakeRun& run, const ReadPositions& read, StageProgress& progress) {
  Job& job = run.job;
  const auto classes = bakedClasses(job);
  ClassOptions options;
  options.blend_error_m = *job.options.classes.blend_error_m;
  for (size_t c = 0; c < classes.size(); ++c) {
    const auto tell = [&](double share) {
      progress.done((c + share) / classes.size(), "warp " + classes[c]->name);
      return !run.stopped();
    };
    auto plan = planClass(job.capture, *classes[c], {job.mesh.decoded.topology, read}, options, tell);
    if (!plan) return plan.error().id == ErrorId::Interrupted ? interrupted() : plan.error();
    FOURDVT_TRY(growBounds(job, plan.value(), read));
    addStream(job, classes[c]->name, plan.take());
  }
  return {};
}

double warpWork(const Job& job) {
  double member_phases = 0;
  for (const capture::CaptureClass* c : bakedClasses(job)) member_phases += expectedPhases(job, *c) * c->members.size();
  return infoOf(Stage::Warp).work_s * member_phases;
}

}  // namespace

std::vector<const capture::CaptureClass*> bakedClasses(const Job& job) {
  std::vector<const capture::CaptureClass*> out;
  if (!job.options.classes.bake) return out;
  for (const capture::CaptureClass& c : job.capture.classes) out.push_back(&c);
  return out;
}

uint32_t expectedPhases(const Job& job, const capture::CaptureClass& motion_class) {
  uint32_t phases = 0;
  for (const auto& member : motion_class.members)
    if (const auto* source = job.capture.find(member.sequence)) phases = std::max(phases, source->frame_count);
  return phases;
}

Status planStreams(BakeRun& run) {
  StageClock::Span span(run.clock, Stage::Warp);
  Job& job = run.job;
  StageProgress progress(run.progress, warpWork(job));
  MeshReader meshes(job);
  const ReadPositions read = meshes.function();
  job.streams.clear();
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    if (run.stopped()) return interrupted();
    FOURDVT_ASSIGN(auto plan, planSequence(job, sequence, read));
    addStream(job, sequence.name, std::move(plan));
  }
  return planClasses(run, read, progress);
}

}  // namespace fourdvt::bake
