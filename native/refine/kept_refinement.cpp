// SPDX-License-Identifier: Apache-2.0
#include "refine/refinement_bytes.h"

#include <string_view>
#include <type_traits>

#include "base/bytes.h"
#include "base/hash.h"

namespace fourdvt::refine {
namespace {

// One list of fields for both directions: visit(archive, value) writes or reads.
struct Writer {
  static constexpr bool reads = false;
  ByteWriter out;
  bool ok() const { return true; }
  template <class T>
  void raw(const T& value) {
    if constexpr (std::is_same_v<T, float>)
      out.f32(value);
    else if constexpr (std::is_same_v<T, double>)
      out.f64(value);
    else
      out.u32(static_cast<uint32_t>(value));
  }
  void raw(const uint8_t& value) { out.u8(value); }
};

struct Reader {
  static constexpr bool reads = true;
  explicit Reader(std::span<const uint8_t> bytes) : in(bytes) {}
  ByteReader in;
  bool ok() const { return in.ok(); }
  template <class T>
  void raw(T& value) {
    if constexpr (std::is_same_v<T, float>)
      value = in.f32();
    else if constexpr (std::is_same_v<T, double>)
      value = in.f64();
    else
      value = static_cast<T>(in.u32());
  }
  void raw(uint8_t& value) { value = in.u8(); }
};

template <class A, class T>
requires std::is_arithmetic_v<T>
void visit(A& a, T& value) { a.raw(value); }
template <class A>
void visit(A& a, glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) a.raw(v[i]);
}

template <class A, class T>
void visitList(A& a, std::vector<T>& list);
template <class A>
void visit(A& a, std::string& text) {
  std::vector<uint8_t> bytes(text.begin(), text.end());
  visitList(a, bytes);
  text.assign(bytes.begin(), bytes.end());
}
template <class A, class T>
void visit(A& a, std::vector<T>& list) {
  visitList(a, list);
}
template <class A, class T>
void visit(A& a, std::optional<T>& value) {
  uint8_t has = value.has_value();
  a.raw(has);
  if (!has) return value.reset();
  if (!value) value = T();
  visit(a, *value);
}
template <class A>
void visit(A& a, Residuals& r) {
  visit(a, r.points);
  visit(a, r.bias_pixels);
  visit(a, r.median_pixels);
  visit(a, r.p95_pixels);
}
template <class A>
void visit(A& a, CameraShift& s) {
  visit(a, s.pixels);
  visit(a, s.deviation_pixels);
}
template <class A>
void visit(A& a, CameraRefinement& c) {
  visit(a, c.name);
  visit(a, c.before);
  visit(a, c.after);
  visit(a, c.measured_bias_pixels);
  for (double* v : {&c.used_bias_pixels, &c.move_m, &c.zoom_percent}) visit(a, *v);
  visit(a, c.best);
  visit(a, c.changed);
  visit(a, c.turn_deg);
  visit(a, c.turn_deviation_deg);
}
template <class A>
void visit(A& a, WorstPicture& w) {
  visit(a, w.sequence);
  visit(a, w.frame);
  visit(a, w.camera);
  visit(a, w.before);
  visit(a, w.after);
  for (int* v : {&w.picture.width, &w.picture.height, &w.picture.channels}) visit(a, *v);
  visit(a, w.picture.pixels);
}
template <class A>
void visit(A& a, PinholeCamera& c) {
  visit(a, c.fx);
  visit(a, c.fy);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) visit(a, c.cam_from_world[column][row]);
}
template <class A>
void visit(A& a, capture::SlowOffsets& s) {
  visit(a, s.frames);
  visit(a, s.offset_m);
  visit(a, s.loop_frames);
}

template <class A, class T>
void visitList(A& a, std::vector<T>& list) {
  uint32_t count = static_cast<uint32_t>(list.size());
  a.raw(count);
  if constexpr (A::reads) {
    list.clear();
    for (uint32_t i = 0; i < count && a.ok(); ++i) visit(a, list.emplace_back());
  } else {
    for (T& item : list) visit(a, item);
  }
}

template <class A>
void visit(A& a, capture::SurfaceOffsets& s) {
  visit(a, s.same_as);
  visit(a, s.constant_m);
  std::vector<std::string> names;
  for (const auto& [name, slow] : s.slow) names.push_back(name);
  visit(a, names);
  for (const std::string& name : names) visit(a, s.slow[name]);
}

// What a refinement changes in a capture.
template <class A>
void visitChange(A& a, Refinement& r) {
  std::optional<capture::SurfaceOffsets> offsets;
  if (r.offsets) offsets = *r.offsets;
  visit(a, offsets);
  if (offsets) r.offsets = std::make_shared<capture::SurfaceOffsets>(std::move(*offsets));
  for (PinholeCamera& camera : r.cameras) visit(a, camera);
}

template <class A>
void visitAll(A& a, Refinement& r) {
  visit(a, r.options.outline);
  visit(a, r.options.cameras);
  visit(a, r.options.matte_bias_pixels);
  visitChange(a, r);
  visit(a, r.by_camera);
  visit(a, r.before);
  visit(a, r.after);
  visit(a, r.worst);
  visit(a, r.frames);
  visit(a, r.rounds);
  visit(a, r.slow);
  visit(a, r.note);
  for (double* v : {&r.offset_low_m, &r.offset_median_m, &r.offset_high_m}) visit(a, *v);
}

uint64_t hashOf(std::span<const uint8_t> bytes) {
  return fnv1a(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), kFnv1aStart);
}

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

std::vector<uint8_t> refinementBytes(const Refinement& refinement) {
  Writer writer;
  Refinement copy = refinement;
  visitAll(writer, copy);
  const uint64_t sum = hashOf(writer.out.data());
  writer.out.u64(sum);
  return writer.out.take();
}

uint64_t changeHash(const Refinement& refinement) {
  Writer writer;
  Refinement copy;
  copy.offsets = refinement.offsets;
  copy.cameras = refinement.cameras;
  visitChange(writer, copy);
  return hashOf(writer.out.data());
}

bool refinementFrom(std::span<const uint8_t> all, const capture::Capture& capture, Refinement& out) {
  out = {};
  if (all.size() < sizeof(uint64_t)) return false;
  const auto bytes = all.first(all.size() - sizeof(uint64_t));
  if (ByteReader(all.last(sizeof(uint64_t))).u64() != hashOf(bytes)) return false;
  for (const capture::CaptureCamera& camera : capture.cameras) out.cameras.push_back(camera.pinhole);
  Reader reader(bytes);
  visitAll(reader, out);
  return reader.ok() && reader.in.remaining() == 0 && out.by_camera.size() == out.cameras.size() &&
         (!out.offsets || fits(*out.offsets, capture.topology.vertex_count));
}

}  // namespace fourdvt::refine
