// SPDX-License-Identifier: Apache-2.0
#include "bake/run/job_bytes.h"

#include <map>
#include <type_traits>

#include "base/bytes.h"
#include "refine/refinement_bytes.h"

namespace fourdvt::bake {
namespace {

// One list of fields serves both directions: `fields` of a type names them, and is found by the archive's argument.
class Writer {
 public:
  static constexpr bool kReads = false;
  ByteWriter out;
  void raw(const void* data, size_t bytes) { out.bytes({static_cast<const uint8_t*>(data), bytes}); }
  uint32_t count(size_t n) {
    out.u32(static_cast<uint32_t>(n));
    return static_cast<uint32_t>(n);
  }
};

class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(std::span<const uint8_t> bytes) : in(bytes) {}
  ByteReader in;
  void raw(void* data, size_t bytes) {
    const auto part = in.bytes(bytes);
    if (part.size() == bytes && bytes > 0) std::memcpy(data, part.data(), bytes);
  }
  // At most as many as there can be.
  uint32_t count(size_t) {
    const uint32_t n = in.u32();
    return n <= in.remaining() ? n : 0;
  }
};

template <class A, class T>
void visit(A& a, T& value);

template <class A, class... Ts>
void all(A& a, Ts&... values) {
  (visit(a, values), ...);
}

template <class A>
void fields(A& a, PinholeCamera& c) {
  all(a, c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.cam_from_world);
}
template <class A>
void fields(A& a, capture::CaptureCamera& c) {
  all(a, c.pinhole, c.distortion);
}
template <class A>
void fields(A& a, capture::CaptureSound& s) {
  all(a, s.path, s.offset_s);
}
template <class A>
void fields(A& a, capture::CaptureSequence& s) {
  all(a, s.name, s.frame_count, s.loop, s.root_velocity_mps, s.folder, s.mesh_pattern, s.first_mesh, s.packed_positions,
      s.packed_units_per_metre, s.test_frames, s.first_frame, s.offset_frames, s.sound);
}
template <class A>
void fields(A& a, capture::CaptureClass::MemberOf& m) {
  all(a, m.sequence, m.parameter);
}
template <class A>
void fields(A& a, capture::CaptureClass& c) {
  all(a, c.name, c.parameters, c.members, c.footstep);
}
template <class A>
void fields(A& a, MeshTopology& t) {
  all(a, t.vertex_count, t.uvs, t.face_vertices, t.face_uvs);
}
// Without offsets, which the refinement has.
template <class A>
void fields(A& a, capture::Capture& c) {
  all(a, c.folder, c.name, c.credit, c.fps, c.metres_per_unit, c.ground_y_m, c.cameras, c.sequences, c.classes,
      c.cameras_folder, c.background_folder, c.background_kind, c.room, c.meshes, c.topology);
}
template <class A>
void fields(A& a, LowerRendition& r) {
  all(a, r.size, r.crf, r.codec, r.preset);
}
template <class A>
void fields(A& a, CameraOptions& o) {
  all(a, o.tile_scale, o.max_texels, o.faces, o.method, o.choice);
}
template <class A>
void fields(A& a, BakeOptions& o) {
  all(a, o.capture_folder, o.character_folder, o.sequences, o.camera_names, o.appearance, o.layers, o.texture, o.crf,
      o.gop, o.jobs, o.resume, o.position_step_m, o.coarse_step_m, o.gutter_texels, o.refine, o.refine_asked, o.penalty,
      o.equal_layers, o.colour_calibration, o.resample, o.codec, o.preset, o.lower_renditions, o.standard_renditions,
      o.classes, o.cameras, o.survey_folder, o.survey_window_frames);
}
template <class A>
void fields(A& a, package::BaseMesh& m) {
  all(a, m.topology, m.positions);
}
template <class A>
void fields(A& a, package::EncodedBaseMesh& m) {
  all(a, m.bytes, m.source_vertex, m.source_face, m.decoded, m.position_attribute, m.uv_attribute, m.colour_attribute,
      m.point_count, m.point_bounds);
}
template <class A>
void fields(A& a, TileLayout& l) {
  all(a, l.width, l.height, l.layers, l.barcode);
}
template <class A>
void fields(A& a, EncodeSettings& s) {
  all(a, s.width, s.height, s.fps, s.crf, s.codec, s.preset, s.extra);
}
template <class A>
void fields(A& a, RenditionPlan& r) {
  all(a, r.suffix, r.layout, r.tiles, r.encode, r.shrunk, r.eighths);
}
template <class A>
void fields(A& a, CameraLayout& l) {
  all(a, l.width, l.height, l.gops, l.picture_width, l.picture_height, l.barcode);
}
template <class A>
void fields(A& a, package::Member& m) {
  all(a, m.name, m.parameter, m.duration_s, m.travel);
}
template <class A>
void fields(A& a, package::ParameterSample& s) {
  all(a, s.at, s.weights, s.offsets);
}
template <class A>
void fields(A& a, package::ParameterSpace& s) {
  all(a, s.names, s.samples, s.simplices);
}
// Without its sequence or class, to which plans point.
template <class A>
void fields(A& a, ClassMember& m) {
  all(a, m.source_frame, m.root);
}
template <class A>
void fields(A& a, ClassPlan& p) {
  all(a, p.frame_count, p.fps, p.loop, p.members, p.manifest, p.space, p.reference_weights, p.linear_error_m,
      p.hybrid_error_m, p.notes);
}
template <class A>
void fields(A& a, StreamPlan& p) {
  all(a, p.name, p.motion, p.cameras, p.renditions, p.gop_first_frames, p.detail_correlation);
}
template <class A>
void fields(A& a, Job& j) {
  all(a, j.options, j.capture, j.cameras, j.streams, j.refinement_path, j.mesh, j.bounds, j.length_scale, j.layout,
      j.encode, j.total_frames, j.notes, j.settings_key, j.capture_keys, j.input_digests, j.mesh_digests,
      j.common_input_digest, j.sound_digest);
}

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class K, class V>
struct IsMap<std::map<K, V>> : std::true_type {};

template <class A, class V>
void visitVector(A& a, V& values) {
  const uint32_t n = a.count(values.size());
  if (A::kReads) values.resize(n);
  using T = typename V::value_type;
  if constexpr (std::is_trivially_copyable_v<T> && !IsOptional<T>::value) {
    a.raw(values.data(), n * sizeof(T));
  } else {
    for (T& value : values) visit(a, value);
  }
}

template <class A, class M>
void visitMap(A& a, M& map) {
  const uint32_t n = a.count(map.size());
  if constexpr (A::kReads) {
    for (uint32_t i = 0; i < n; ++i) {
      typename M::key_type key{};
      visit(a, key);
      visit(a, map[key]);
    }
  } else {
    for (auto& [key, value] : map) {
      auto copy = key;
      all(a, copy, value);
    }
  }
}

template <class A, class T>
void visit(A& a, T& value) {
  if constexpr (requires { fields(a, value); }) {
    fields(a, value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value.resize(a.count(value.size()));
    a.raw(value.data(), value.size());
  } else if constexpr (IsOptional<T>::value) {
    bool has = value.has_value();
    a.raw(&has, 1);
    if (A::kReads && has) value.emplace();
    if (value) visit(a, *value);
  } else if constexpr (IsVector<T>::value) {
    visitVector(a, value);
  } else if constexpr (IsMap<T>::value) {
    visitMap(a, value);
  } else {
    static_assert(std::is_trivially_copyable_v<T>);
    a.raw(&value, sizeof value);
  }
}

// Pointers of streams, as numbers in the capture: a class or -1, then the members' sequences.
template <class A>
void visitPointers(A& a, Job& job) {
  const auto& sequences = job.capture.sequences;
  const auto& classes = job.capture.classes;
  for (StreamPlan& stream : job.streams) {
    const auto visitOne = [&](auto*& pointer, const auto& list) {
      int32_t number = !A::kReads && pointer ? static_cast<int32_t>(pointer - list.data()) : -1;
      a.raw(&number, sizeof number);
      if (A::kReads) pointer = number >= 0 && size_t(number) < list.size() ? &list[number] : nullptr;
    };
    visitOne(stream.motion.source, classes);
    for (ClassMember& member : stream.motion.members) visitOne(member.source, sequences);
  }
}

}  // namespace

std::vector<uint8_t> jobBytes(const Job& given) {
  Job job = given;  // its streams point into `given`
  job.streams = given.streams;
  Writer writer;
  fields(writer, job);
  for (StreamPlan& stream : job.streams) {
    if (stream.motion.source)
      stream.motion.source = &job.capture.classes[stream.motion.source - given.capture.classes.data()];
    for (ClassMember& member : stream.motion.members)
      member.source = &job.capture.sequences[member.source - given.capture.sequences.data()];
  }
  visitPointers(writer, job);
  std::vector<uint8_t> bytes_of_refinement;
  if (given.refinement) {
    refine::Refinement refinement = *given.refinement;
    for (refine::WorstPicture& worst : refinement.worst) worst.picture = {};
    bytes_of_refinement = refine::refinementBytes(refinement);
  }
  visit(writer, bytes_of_refinement);
  return writer.out.take();
}

bool jobFrom(std::span<const uint8_t> bytes, Job& job) {
  job = {};
  Reader reader(bytes);
  fields(reader, job);
  visitPointers(reader, job);
  std::vector<uint8_t> bytes_of_refinement;
  visit(reader, bytes_of_refinement);
  if (!reader.in.ok() || reader.in.remaining() > 0) return false;
  for (const StreamPlan& stream : job.streams)
    for (const ClassMember& member : stream.motion.members)
      if (!member.source) return false;
  if (bytes_of_refinement.empty()) return true;
  refine::Refinement refinement;
  if (!refine::refinementFrom(bytes_of_refinement, job.capture, refinement)) return false;
  refine::applyRefinement(refinement, job.capture);
  job.refinement = std::move(refinement);
  return true;
}

}  // namespace fourdvt::bake
