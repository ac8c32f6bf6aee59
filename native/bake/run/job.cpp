// SPDX-License-Identifier: Apache-2.0
#include "bake/run/job.h"

#include <cmath>

#include "capture/folder/archive.h"
#include "refine/refine.h"
#include "store/folder.h"

namespace fourdvt::store {
namespace {

// Pointers of streams, as numbers in the capture: a class or -1, then the members' sequences.
void pointers(Archive& a, bake::Job& job) {
  const auto pointer = [&](auto*& value, const auto& list) {
    auto number = !a.reads() && value ? static_cast<int32_t>(value - list.data()) : -1;
    a(number);
    if (a.reads()) value = number >= 0 && size_t(number) < list.size() ? &list[number] : nullptr;
  };
  for (bake::StreamPlan& stream : job.streams) {
    pointer(stream.motion.source, job.capture.classes);
    for (bake::ClassMember& member : stream.motion.members) pointer(member.source, job.capture.sequences);
  }
}

}  // namespace

void fields(Archive& a, bake::LowerRendition& r) { a(r.size, r.crf, r.codec, r.preset); }
void fields(Archive& a, bake::CameraOptions& o) { a(o.tile_scale, o.max_texels, o.faces, o.method, o.choice); }
void fields(Archive& a, bake::BakeOptions& o) {
  a(o.capture_folder, o.character_folder, o.sequences, o.camera_names, o.appearance, o.layers, o.texture, o.crf, o.gop,
    o.jobs, o.resume, o.position_step_m, o.coarse_step_m, o.gutter_texels, o.refine, o.refine_asked, o.penalty,
    o.equal_layers, o.colour_calibration, o.resample, o.codec, o.preset, o.lower_renditions, o.standard_renditions,
    o.classes, o.cameras, o.survey_folder, o.survey_window_frames);
}
void fields(Archive& a, package::BaseMesh& m) { a(m.topology, m.positions); }
void fields(Archive& a, package::EncodedBaseMesh& m) {
  a(m.bytes, m.source_vertex, m.source_face, m.decoded, m.position_attribute, m.uv_attribute, m.colour_attribute,
    m.point_count, m.point_bounds);
}
void fields(Archive& a, encode::TileLayout& l) { a(l.width, l.height, l.layers, l.barcode); }
void fields(Archive& a, encode::EncodeSettings& s) { a(s.width, s.height, s.fps, s.crf, s.codec, s.preset, s.extra); }
void fields(Archive& a, bake::RenditionPlan& r) { a(r.suffix, r.layout, r.tiles, r.encode, r.shrunk, r.eighths); }
void fields(Archive& a, encode::CameraLayout& l) {
  a(l.width, l.height, l.gops, l.picture_width, l.picture_height, l.barcode);
}
void fields(Archive& a, package::Member& m) { a(m.name, m.parameter, m.duration_s, m.travel); }
void fields(Archive& a, package::ParameterSample& s) { a(s.at, s.weights, s.offsets); }
void fields(Archive& a, package::ParameterSpace& s) { a(s.names, s.samples, s.simplices); }
// All fields except sequence and class, which plans store as pointers.
void fields(Archive& a, bake::ClassMember& m) { a(m.source_frame, m.root); }
void fields(Archive& a, bake::ClassPlan& p) {
  a(p.frame_count, p.fps, p.loop, p.members, p.manifest, p.space, p.reference_weights, p.linear_error_m,
    p.hybrid_error_m, p.notes);
}
void fields(Archive& a, bake::StreamPlan& p) {
  a(p.name, p.motion, p.cameras, p.renditions, p.gop_first_frames, p.detail_correlation);
}
// All fields except the cameras' regions, which are no longer needed after planning, and the pictures of the
// refinement, which only its report shows.
void fields(Archive& a, bake::Job& j) {
  a(j.options, j.capture, j.cameras, j.streams, j.refinement_path, j.mesh, j.bounds, j.length_scale, j.layout, j.encode,
    j.total_frames, j.notes, j.settings_key, j.capture_keys, j.input_digests, j.mesh_digests, j.common_input_digest,
    j.sound_digest);
  pointers(a, j);
  std::optional<refine::Refinement> refinement = j.refinement;
  if (refinement)
    for (refine::WorstPicture& worst : refinement->worst) worst.picture = {};
  a(refinement);
  if (a.reads()) j.refinement = std::move(refinement);
}

}  // namespace fourdvt::store

namespace fourdvt::bake {

uint32_t StreamPlan::sourceFrame(size_t member, uint32_t frame) const {
  const ClassMember& m = motion.members[member];
  return static_cast<uint32_t>(std::llround(m.source_frame[frame])) % m.source->frame_count;
}

uint32_t Job::streamFrames() const {
  uint32_t sum = 0;
  for (const StreamPlan& stream : streams) sum += stream.frameCount();
  return sum;
}

Positions reordered(const package::EncodedBaseMesh& mesh, const Positions& source) {
  Positions out;
  out.reserve(mesh.source_vertex.size());
  for (uint32_t v : mesh.source_vertex) out.push_back(source[v]);
  return out;
}

Status saveJob(const std::string& path, const Job& job) { return store::save(path, job); }

Result<Job> loadJob(const std::string& path) {
  FOURDVT_ASSIGN(auto job, store::load<Job>(path));
  for (const StreamPlan& stream : job.streams)
    for (const ClassMember& member : stream.motion.members)
      if (!member.source) return store::damagedFile(path);
  if (job.refinement) refine::applyRefinement(*job.refinement, job.capture);
  return job;
}

}  // namespace fourdvt::bake
