// SPDX-License-Identifier: Apache-2.0
#include "base/hash.h"
#include "refine/refine.h"
#include "store/folder.h"

namespace fourdvt::store {

void fields(Archive& a, refine::RefineOptions& o) { a(o.outline, o.cameras, o.matte_bias_pixels); }
void fields(Archive& a, refine::Residuals& r) { a(r.points, r.bias_pixels, r.median_pixels, r.p95_pixels); }
void fields(Archive& a, refine::CameraRefinement& c) {
  a(c.name, c.before, c.after, c.measured_bias_pixels, c.used_bias_pixels, c.best, c.changed, c.turn_deg,
    c.turn_deviation_deg, c.move_m, c.zoom_percent);
}
void fields(Archive& a, refine::WorstPicture& w) { a(w.sequence, w.frame, w.camera, w.before, w.after, w.picture); }
void fields(Archive& a, capture::SlowOffsets& s) { a(s.frames, s.offset_m, s.loop_frames); }
void fields(Archive& a, capture::SurfaceOffsets& s) { a(s.same_as, s.constant_m, s.slow); }
void fields(Archive& a, refine::Refinement& r) {
  a(r.options, r.offsets, r.cameras, r.by_camera, r.before, r.after, r.worst, r.frames, r.rounds, r.slow, r.note,
    r.offset_low_m, r.offset_median_m, r.offset_high_m);
}

}  // namespace fourdvt::store

namespace fourdvt::refine {
namespace {

bool fits(const capture::SurfaceOffsets& offsets, uint32_t vertices) {
  if (offsets.same_as.size() != vertices || offsets.constant_m.size() != vertices) return false;
  for (const uint32_t v : offsets.same_as)
    if (v >= vertices) return false;
  for (const auto& [name, slow] : offsets.slow) {
    if (slow.frames.empty() || slow.frames.size() != slow.offset_m.size()) return false;
    for (const auto& at : slow.offset_m)
      if (at.size() != vertices) return false;
  }
  return true;
}

}  // namespace

Result<Refinement> loadRefinement(const std::string& path, const capture::Capture& capture) {
  FOURDVT_ASSIGN(auto out, store::load<Refinement>(path));
  if (out.cameras.size() != capture.cameras.size() || out.by_camera.size() != out.cameras.size() ||
      (out.offsets && !fits(*out.offsets, capture.topology.vertex_count)))
    return store::damagedFile(path);
  return out;
}

uint64_t changeHash(const Refinement& refinement) {
  return fnv1a(store::bytesOf(refinement.cameras), fnv1a(store::bytesOf(refinement.offsets)));
}

}  // namespace fourdvt::refine
