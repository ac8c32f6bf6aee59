// SPDX-License-Identifier: Apache-2.0
// Rigs and frames of COLMAP, by its documentation ("Output Format"):
//    rig: number, count of sensors, kind and number of the reference; for each other sensor its kind, number, pose flag
//    and pose; frame: number, rig, pose of the rig, count of data, and for each datum kind and number of the sensor and
//    number of the image. Kinds are words in the text; 0 is a camera in the binary form.

#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "base/bytes.h"
#include "capture/colmap_model.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

using Pose = std::array<double, 7>;
using Sensor = std::pair<bool, uint64_t>;  // true for a camera; number

struct Rig {
  std::optional<Sensor> reference;
  std::map<Sensor, std::optional<Pose>> sensors;  // sensor from rig
};
using Rigs = std::map<uint64_t, Rig>;

// Composition: first `b`, then `a`.
Pose composed(const Pose& a, const Pose& b) {
  const glm::dquat first = glm::normalize(glm::dquat(b[0], b[1], b[2], b[3]));
  const glm::dquat second = glm::normalize(glm::dquat(a[0], a[1], a[2], a[3]));
  const glm::dquat q = second * first;
  const glm::dvec3 t = second * glm::dvec3(b[4], b[5], b[6]) + glm::dvec3(a[4], a[5], a[6]);
  return {q.w, q.x, q.y, q.z, t.x, t.y, t.z};
}

// Adds an image of `sensor`; `frame`: the rig's pose.
void addImage(const Rig& rig, const Sensor& sensor, const Pose& frame, uint64_t image, RigPoses& out) {
  if (!sensor.first) return;
  if (rig.reference == sensor) out[image] = frame;
  const auto found = rig.sensors.find(sensor);
  if (found != rig.sensors.end() && found->second) out[image] = composed(*found->second, frame);
}

Sensor nextSensor(Fields& fields) {
  const bool camera = fields.word() == "CAMERA";
  return {camera, fields.number<uint64_t>()};
}

Pose nextPose(Fields& fields) {
  Pose out{};
  for (double& value : out) value = fields.number<double>();
  return out;
}

Result<Rigs> rigsOfText(std::string_view text, const std::string& file) {
  Rigs out;
  TextLines lines(text);
  for (std::string_view line; lines.next(line);) {
    Fields fields(line);
    Rig& rig = out[fields.number<uint64_t>()];
    const auto sensors = fields.number<uint64_t>();
    if (sensors > 0) rig.reference = nextSensor(fields);
    for (uint64_t i = 1; i < sensors && fields.problem().empty(); ++i) {
      std::optional<Pose>& pose = rig.sensors[nextSensor(fields)];
      if (fields.number<int>() == 1) pose = nextPose(fields);
    }
    if (!fields.problem().empty()) return colmapPoseError(atLine(file, lines.number()), fields.problem());
  }
  return out;
}

Sensor nextSensor(ByteReader& in) {
  const bool camera = in.u32() == 0;
  return {camera, in.u32()};
}

Pose nextPose(ByteReader& in) {
  Pose out{};
  for (double& value : out) value = in.f64();
  return out;
}

Rigs rigsOfBytes(ByteReader& in) {
  Rigs out;
  for (uint64_t left = in.u64(); in.ok() && left > 0; --left) {
    Rig& rig = out[in.u32()];
    const uint32_t sensors = in.u32();
    if (sensors > 0) rig.reference = nextSensor(in);
    for (uint32_t i = 1; i < sensors && in.ok(); ++i) {
      std::optional<Pose>& pose = rig.sensors[nextSensor(in)];
      if (in.u8() == 1) pose = nextPose(in);
    }
  }
  return out;
}

}  // namespace

Result<RigPoses> parseRigsText(std::string_view rigs_text, std::string_view frames_text, const std::string& path) {
  FOURDVT_ASSIGN(const Rigs rigs, rigsOfText(rigs_text, path + "/rigs.txt"));
  RigPoses out;
  TextLines lines(frames_text);
  for (std::string_view line; lines.next(line);) {
    const std::string where = atLine(path + "/frames.txt", lines.number());
    Fields fields(line);
    fields.number<uint64_t>();  // frame number
    const auto rig = rigs.find(fields.number<uint64_t>());
    const Pose pose = nextPose(fields);
    const auto data = fields.number<uint64_t>();
    if (fields.problem().empty() && rig == rigs.end())
      return colmapPoseError(where, "the frame refers to a rig that rigs.txt does not list");
    for (uint64_t i = 0; i < data && fields.problem().empty(); ++i) {
      const Sensor sensor = nextSensor(fields);
      const auto image = fields.number<uint64_t>();
      if (fields.problem().empty()) addImage(rig->second, sensor, pose, image, out);
    }
    if (!fields.problem().empty()) return colmapPoseError(where, fields.problem());
  }
  return out;
}

Result<RigPoses> parseRigsBinary(std::string_view rigs_bytes, std::string_view frames_bytes, const std::string& path) {
  ByteReader rigs_in(bytesOf(rigs_bytes)), in(bytesOf(frames_bytes));
  const Rigs rigs = rigsOfBytes(rigs_in);
  if (!rigs_in.ok()) return colmapCutOff(path + "/rigs.bin");
  RigPoses out;
  for (uint64_t left = in.u64(); in.ok() && left > 0; --left) {
    const std::string where = path + "/frames.bin: frame " + std::to_string(in.u32()) + ": ";
    const auto rig = rigs.find(in.u32());
    const Pose pose = nextPose(in);
    const uint32_t data = in.u32();
    if (in.ok() && rig == rigs.end()) return colmapPoseError(where, "it refers to a rig that rigs.bin does not list");
    for (uint32_t i = 0; i < data && in.ok(); ++i) {
      const Sensor sensor = nextSensor(in);
      const uint64_t image = in.u64();
      if (in.ok()) addImage(rig->second, sensor, pose, image, out);
    }
  }
  if (!in.ok()) return colmapCutOff(path + "/frames.bin");
  return out;
}

}  // namespace fourdvt::capture
