// SPDX-License-Identifier: Apache-2.0
#include "lab/study/motion/truth.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "bake/run/job.h"
#include "base/text.h"
#include "lab/measure/motion_metrics.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

constexpr size_t kAlignmentBytes = 12;

std::string at(const std::string& list, size_t i) { return list + "/" + std::to_string(i); }

// Replaces "%04d" in the pattern by a number.
std::string numbered(std::string pattern, uint32_t number) {
  const std::string digits = printed("%04u", number);
  const size_t place = pattern.find("%04d");
  if (place != std::string::npos) pattern.replace(place, 4, digits);
  return pattern;
}

Error damaged(const std::string& path) {
  return {ErrorId::FileUnreadable, path + ": is damaged; make the capture again with `fourdvt-lab studio`"};
}

}  // namespace

Result<std::unique_ptr<MotionTruth>> MotionTruth::open(const StudyContext& context, const package::Sequence& motion,
                                                       Baked baked) {
  const std::string folder = context.capture->folder + "/truth/" + motion.name, path = folder + "/truth.json";
  std::error_code ignored;
  if (motion.members.size() != 2 || !std::filesystem::exists(path, ignored)) return std::unique_ptr<MotionTruth>();
  FOURDVT_ASSIGN(auto json, platform::readJsonFlat(path));
  std::unique_ptr<MotionTruth> truth(new MotionTruth(*context.capture, folder, std::move(baked), motion.loop));
  FOURDVT_TRY(truth->read(json, motion));
  if (truth->instants_.empty() || truth->steps_.empty()) return std::unique_ptr<MotionTruth>();
  return truth;
}

Status MotionTruth::read(const FlatJson& json, const package::Sequence& motion) {
  size_t member_of[2] = {};  // indices of the class's members among the truth's
  std::vector<std::string> names;
  for (size_t i = 0; json.has(at("/members", i)); ++i) names.push_back(json.string(at("/members", i)).value_or(""));
  for (size_t m = 0; m < 2; ++m) {
    const auto found = std::find(names.begin(), names.end(), motion.members[m].name);
    if (found == names.end()) return damaged(folder_ + "/truth.json");
    member_of[m] = static_cast<size_t>(found - names.begin());
  }
  for (size_t i = 0; json.has(at("/steps", i)); ++i) {
    const std::string step = at("/steps", i);
    steps_.push_back({json.number(at(step + "/weights", member_of[1])).value_or(0),
                      json.string(step + "/pictures").value_or(""), json.string(step + "/positions").value_or("")});
  }
  for (size_t i = 0; json.has(at("/phases", i)); ++i)
    instants_.push_back({static_cast<uint32_t>(i), json.number(at("/phases", i)).value_or(0)});
  units_per_metre_ = json.number("/mesh/units_per_metre").value_or(0);
  if (!(units_per_metre_ > 0)) return damaged(folder_ + "/truth.json");
  const bool forwards = member_of[0] < member_of[1];
  if (forwards) alignment_ = json.string("/alignment/0/files").value_or("");
  FOURDVT_ASSIGN(auto cameras, capture::readColmapCameras(folder_ + "/cameras"));
  for (const auto& camera : cameras) cameras_.push_back(camera.pinhole);
  return {};
}

double MotionTruth::classPhase(double w, const Instant& instant) const {
  return measure::commonFrame(baked_.passed[0], baked_.passed[1], loop_, w, instant.phase);
}

uint32_t MotionTruth::classFrame(double w, const Instant& instant) const {
  return static_cast<uint32_t>(std::lround(classPhase(w, instant))) % static_cast<uint32_t>(baked_.passed[0].size());
}

Result<Image> MotionTruth::picture(const Step& step, const PinholeCamera& camera, const Instant& instant) const {
  std::string name = step.pictures;
  const size_t place = name.find("CAMERA");
  if (place != std::string::npos) name.replace(place, 6, camera.name);
  const std::string path = folder_ + "/" + numbered(name, instant.number);
  FOURDVT_ASSIGN(auto picture, platform::readImage(path));
  const Image& p = picture;
  if (p.channels != 4 || p.width != camera.width || p.height != camera.height) return damaged(path);
  return picture;
}

Result<Positions> MotionTruth::mesh(const Step& step, const Instant& instant) const {
  const std::string path = folder_ + "/" + step.positions;
  const uint64_t bytes = uint64_t(6) * capture_.topology.vertex_count;
  FOURDVT_ASSIGN(auto packed, platform::readFileRange(path, bytes * instant.number, bytes));
  std::vector<int16_t> units(packed.size() / 2);
  std::memcpy(units.data(), packed.data(), 2 * units.size());
  Positions source(capture_.topology.vertex_count);
  for (size_t v = 0; v < source.size(); ++v)
    source[v] = glm::vec3(glm::dvec3(units[3 * v], units[3 * v + 1], units[3 * v + 2]) / units_per_metre_);
  return bake::reordered(baked_.mesh, source);
}

Result<Positions> MotionTruth::moved(const Instant& instant, const Positions& mesh) const {
  const std::string path = folder_ + "/" + numbered(alignment_, instant.number);
  FOURDVT_ASSIGN(auto bytes, platform::readFile(path));
  const MeshTopology& topology = capture_.topology;
  if (bytes.size() != kAlignmentBytes * topology.vertex_count) return damaged(path);
  Positions source(topology.vertex_count), out(mesh.size());
  for (size_t v = 0; v < mesh.size(); ++v) source[baked_.mesh.source_vertex[v]] = mesh[v];
  for (size_t v = 0; v < mesh.size(); ++v) {
    const uint8_t* record = bytes.data() + kAlignmentBytes * baked_.mesh.source_vertex[v];
    uint32_t face = 0;
    float second = 0, third = 0;
    std::memcpy(&face, record, 4);
    std::memcpy(&second, record + 4, 4);
    std::memcpy(&third, record + 8, 4);
    if (face >= topology.faceCount()) return damaged(path);
    const glm::uvec3 corners = topology.face_vertices[face];
    out[v] = (1 - second - third) * source[corners.x] + second * source[corners.y] + third * source[corners.z];
  }
  return out;
}

}  // namespace fourdvt::study
