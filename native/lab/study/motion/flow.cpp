// SPDX-License-Identifier: Apache-2.0
// Optical flow between two members' appearance on the same blended mesh and view: GPU flow against OpenCV's, and both
// of them and the baked alignment against the studio's truth.
#include <cmath>
#include <map>

#include "base/mesh.h"
#include "lab/study/motion/motion.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr int kSide = 512;
constexpr const char* kSources[] = {kFlowOpencv, kFlowGpu, kFlowDis, kOpencvDis};

measure::Mask silhouette(const Image& rgba) { return measure::commonSilhouette(rgba, rgba); }

measure::FlowField stillField(const PinholeCamera& camera) {
  return {camera.width, camera.height, std::vector<glm::vec2>(size_t(camera.width) * camera.height, glm::vec2(0))};
}

// Displacement of each face corner by the baked alignment, on the current mesh: along the face, as texture coordinates
// move.
std::vector<glm::vec3> bakedCorners(const MotionStage& stage, const SurfaceFrames& frames) {
  const MeshTopology& topology = stage.mesh().topology;
  const Positions& p = stage.positions();
  std::vector<glm::vec3> out(3 * size_t(topology.faceCount()));
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    const glm::uvec3 v = topology.face_vertices[f], t = topology.face_uvs[f];
    const glm::mat2 uv_edges(topology.uvs[t.y] - topology.uvs[t.x], topology.uvs[t.z] - topology.uvs[t.x]);
    const bool flat = std::abs(glm::determinant(uv_edges)) < 1e-12f;
    for (int k = 0; k < 3; ++k) {
      const size_t corner = 3 * size_t(f) + size_t(k);
      out[corner] = p[v[k]];
      if (flat) continue;
      const glm::vec2 moved_uv = frames.uv_from_tangents[corner] * stage.alignment()[v[k]];
      const glm::vec2 along = glm::inverse(uv_edges) * moved_uv;
      out[corner] += along.x * (p[v.y] - p[v.x]) + along.y * (p[v.z] - p[v.x]);
    }
  }
  return out;
}

std::vector<glm::vec3> cornersOf(const MeshTopology& topology, const Positions& vertices) {
  std::vector<glm::vec3> out;
  for (const glm::uvec3& face : topology.face_vertices)
    for (int k = 0; k < 3; ++k) out.push_back(vertices[face[k]]);
  return out;
}

struct TruthErrors {
  measure::ErrorSamples px, mm;
};

// Adds the displacement errors of the surface points visible in the first picture. The baked displacement is defined at
// the common point, half way along it.
void addTruthErrors(const measure::FlowField& truth, const measure::FlowField& found, bool half_way,
                    const measure::Mask& inside, const std::vector<float>& metres_per_pixel, TruthErrors& out) {
  for (size_t i = 0; i < inside.size(); ++i) {
    if (!inside[i]) continue;
    const glm::dvec2 pixel(double(i % size_t(truth.width)) + 0.5, double(i / size_t(truth.width)) + 0.5);
    const glm::vec2 wanted = truth.displacement[i];
    const glm::vec2 got = half_way ? measure::flowAt(found, pixel + 0.5 * glm::dvec2(wanted)) : found.displacement[i];
    const float error = glm::length(got - wanted);
    out.px.add(error);
    out.mm.add(1e3f * error * metres_per_pixel[i]);
  }
}

class FlowPart {
 public:
  explicit FlowPart(const MotionSubject& subject)
      : subject_(subject),
        stage_(subject.stage),
        frames_(computeSurfaceFrames(stage_.mesh().topology, stage_.mesh().positions)) {}

  Result<Rows> run() {
    const auto azimuths = motionAzimuths_deg(subject_.quick() ? 1 : 4);
    for (const uint32_t phase : subject_.phases(subject_.quick() ? 2 : 5)) {
      FOURDVT_TRY(stage_.show(phase));
      for (const double azimuth : azimuths) FOURDVT_TRY(pair(stage_.orbit(azimuth, kSide, kSide), nullptr));
    }
    const bool known = subject_.truth && subject_.truth->isAligned();
    const size_t instants = !known ? 0 : subject_.quick() ? 1 : subject_.truth->instants().size();
    for (size_t i = 0; i < instants; ++i) {
      const MotionTruth::Instant& instant = subject_.truth->instants()[i];
      FOURDVT_TRY(stage_.show(subject_.truth->classFrame(0.5, instant)));
      FOURDVT_ASSIGN(auto moved, subject_.truth->moved(instant, stage_.positions()));
      const auto corners = cornersOf(stage_.mesh().topology, moved);
      for (const double azimuth : azimuths) FOURDVT_TRY(pair(stage_.orbit(azimuth, kSide, kSide), &corners));
    }
    return rows();
  }

 private:
  // corners: those of the truth; null: compares with OpenCV instead.
  Status pair(const PinholeCamera& camera, const std::vector<glm::vec3>* corners) {
    FOURDVT_TRY(checkStop(subject_.context));
    FOURDVT_ASSIGN(auto look, stage_.draw(camera, 0, kAlignNone));
    const measure::Mask inside = silhouette(look);
    std::map<AlignMethod, measure::FlowField> fields;
    for (const AlignMethod method : kSources) {
      FOURDVT_ASSIGN(fields[method], stage_.flow(camera, method));
    }
    if (!corners) {
      for (const auto& [method, field] : fields)
        if (method != kFlowOpencv) measure::addDifferences(field, fields[kFlowOpencv], inside, against_[method]);
      measure::addDifferences(fields[kFlowOpencv], stillField(camera), inside, size_);
      return {};
    }
    std::vector<float> metres_per_pixel;
    const auto& faces = stage_.mesh().topology.face_vertices;
    const measure::FlowField truth =
        measure::surfaceFlow(camera, faces, stage_.positions(), *corners, &metres_per_pixel);
    fields[kAlignNone] = stillField(camera);
    if (stage_.aligned())
      fields[kAlignBaked] = measure::surfaceFlow(camera, faces, stage_.positions(), bakedCorners(stage_, frames_));
    for (const auto& [method, field] : fields)
      addTruthErrors(truth, field, method == kAlignBaked, inside, metres_per_pixel, errors_[method]);
    return {};
  }

  Rows rows() const {
    Rows out;
    const std::string name = subject_.motion().name, size = " size=" + std::to_string(kSide);
    for (const auto& [method, samples] : against_) {
      const RowWriter row(out, kMotionFlow, name, method, "against=opencv" + size);
      row.add({{kDifferenceMeanPx, samples.mean()}, {kDifferenceTailPx, samples.tail()}});
    }
    const RowWriter reference(out, kMotionFlow, name, kFlowOpencv, "against=none" + size);
    reference.add({{kDifferenceMeanPx, size_.mean()}, {kDifferenceTailPx, size_.tail()}});
    for (const auto& [method, errors] : errors_) {
      const RowWriter row(out, kMotionFlow, name, method, "against=truth" + size);
      row.add({{kDifferenceMeanPx, errors.px.mean()},
               {kDifferenceTailPx, errors.px.tail()},
               {kDifferenceMeanMm, errors.mm.mean()},
               {kDifferenceTailMm, errors.mm.tail()}});
    }
    return out;
  }

  const MotionSubject& subject_;
  MotionStage& stage_;
  const SurfaceFrames frames_;
  std::map<AlignMethod, measure::ErrorSamples> against_;  // OpenCV's Farneback
  measure::ErrorSamples size_;                            // magnitude of OpenCV's flow
  std::map<AlignMethod, TruthErrors> errors_;
};

}  // namespace

Result<Rows> measureFlow(const MotionSubject& subject) { return FlowPart(subject).run(); }

}  // namespace fourdvt::study
