// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/surface_score.h"

#include <cmath>
#include <limits>
#include <optional>

#include "base/mesh.h"
#include "base/text.h"
#include "lab/measure/held_out_truth.h"
#include "lab/measure/matte_agreement.h"
#include "lab/measure/projective.h"
#include "mattes/frame_reader.h"
#include "render/cameras/fvvr.h"

namespace fourdvt::measure {
namespace {

constexpr double kSpacing_m = 0.004;  // between points of a person's surface
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Distance sums of one sequence.
struct Distances {
  std::vector<double> to_reference, from_reference;
  double change_m = 0;
  size_t still = 0;
};

Status compareFrame(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                    const capture::Capture& reference, const TriangleMesh& surface, uint32_t frame, Distances& out) {
  const capture::CaptureSequence* same = reference.find(sequence.name);
  if (!same || same->frame_count != sequence.frame_count) {
    return Error{ErrorId::InvalidArgument, reference.folder + ": has no sequence \"" + sequence.name +
                                               "\" of as many frames as the capture that is scored"};
  }
  FOURDVT_ASSIGN(const TriangleMesh given, capture::readSurfaceFrame(reference, *same, frame));
  const DistanceToSurface to_given(given), to_surface(surface);
  const double spacing_m = kSpacing_m * lengthScale({longestSide(given.positions)});
  for (const glm::dvec3& p : pointsOn(surface, spacing_m)) out.to_reference.push_back(to_given.at(p));
  for (const glm::dvec3& p : pointsOn(given, spacing_m)) out.from_reference.push_back(to_surface.at(p));

  if (reference.meshes != capture::CaptureMeshes::ConstantTopology || frame + 1 >= sequence.frame_count) return {};
  FOURDVT_ASSIGN(const TriangleMesh next_given, capture::readSurfaceFrame(reference, *same, frame + 1));
  FOURDVT_ASSIGN(const TriangleMesh next, capture::readSurfaceFrame(capture, sequence, frame + 1));
  const DistanceToSurface to_next(next);
  for (size_t v = 0; v < given.positions.size(); ++v) {
    if (glm::distance(given.positions[v], next_given.positions[v]) > kStill_m) continue;
    out.change_m +=
        std::abs(to_next.at(glm::dvec3(next_given.positions[v])) - to_surface.at(glm::dvec3(given.positions[v])));
    ++out.still;
  }
  return {};
}

Result<Image> textured(const PinholeCamera& view, const std::vector<PinholeCamera>& cameras,
                       std::span<const Image> pictures, const TriangleMesh& surface,
                       const SurfaceTexturing& texturing) {
  if (!texturing.device) return renderProjective(view, cameras, pictures, surface.faces, surface.positions);
  const auto scale = static_cast<float>(lengthScale({longestSide(surface.positions)}));
  MeshTopology topology;
  topology.vertex_count = static_cast<uint32_t>(surface.positions.size());
  topology.face_vertices = surface.faces;
  FOURDVT_ASSIGN(auto fvvr, render::Fvvr::create(*texturing.device, cameras, topology, {}, scale));
  const render::View seen = render::viewFromCamera(view, {scale, scale});
  const render::FvvrOptions options{.closest = texturing.closest};
  FOURDVT_TRY(fvvr->setFrame(surface.positions, pictures, fvvr->camerasOf(seen, options)));
  return fvvr->renderStill(seen, options);
}

}  // namespace

Result<std::vector<SurfaceScore>> scoreSurfaces(
    const capture::Capture& capture, const capture::Capture* reference, const OpenVideo& open_video,
    const SurfaceTexturing& texturing,
    const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame) {
  FOURDVT_ASSIGN(const auto test_cameras, capture::readTestCameras(capture));
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : capture.cameras) cameras.push_back(camera.pinhole);
  std::vector<SurfaceScore> out;
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    if (sequence.test_frames.empty()) continue;
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, sequence, open_video));
    ScoreLane lane;
    MatteAgreement silhouettes;
    Distances distances;
    double triangles = 0;
    for (const uint32_t frame : sequence.test_frames) {
      reader->skipTo(frame);
      FOURDVT_ASSIGN(const auto captured, reader->next());
      FOURDVT_ASSIGN(const TriangleMesh surface, capture::readSurfaceFrame(capture, sequence, frame));
      triangles += double(surface.faces.size());
      for (const PinholeCamera& camera : test_cameras) {
        FOURDVT_ASSIGN(auto truth, heldOutTruth(sequence, camera, frame));
        FOURDVT_ASSIGN(auto picture, textured(camera, cameras, captured.pictures, surface, texturing));
        silhouettes.add(picture, truth);
        lane.add(std::move(truth), std::move(picture));
      }
      if (reference) FOURDVT_TRY(compareFrame(capture, sequence, *reference, surface, frame, distances));
      if (on_frame) on_frame(sequence.name, frame);
    }
    const MeanScores scores = lane.finishMean();
    const DistanceFigures to = distanceFigures(distances.to_reference),
                          from = distanceFigures(distances.from_reference);
    SurfaceScore score{sequence.name, scores.count(), scores.mean(), triangles / double(sequence.test_frames.size())};
    score.iou = silhouettes.iou();
    score.to_reference_mean_m = reference ? to.mean_m : kNone;
    score.to_reference_median_m = reference ? to.median_m : kNone;
    score.to_reference_p95_m = reference ? to.p95_m : kNone;
    score.from_reference_mean_m = reference ? from.mean_m : kNone;
    score.from_reference_p95_m = reference ? from.p95_m : kNone;
    score.still_points = distances.still;
    score.still_change_m = distances.still ? distances.change_m / double(distances.still) : kNone;
    out.push_back(std::move(score));
  }
  if (!out.empty()) return out;
  return Error{ErrorId::FileMissing,
               capture.folder + "/capture.json: no sequence has \"test_frames\", frames with held-out pictures"};
}

std::string surfaceTable(const std::vector<SurfaceScore>& scores) {
  std::string out =
      "sequence      views  PSNR-FG dB  SSIM-FG  triangles  to reference mm: mean median   95 %  from it: mean   95 %"
      "  still change mm     IoU\n";
  for (const SurfaceScore& s : scores) {
    out += printed("%-12s %6zu %11.2f %8.4f %10.0f %22.2f %6.2f %6.2f %14.2f %6.2f %16.3f %7.4f\n", s.sequence.c_str(),
                   s.views, s.picture.psnr_fg_db, s.picture.ssim_fg, s.triangles, s.to_reference_mean_m * 1e3,
                   s.to_reference_median_m * 1e3, s.to_reference_p95_m * 1e3, s.from_reference_mean_m * 1e3,
                   s.from_reference_p95_m * 1e3, s.still_change_m * 1e3, s.iou);
  }
  return out;
}

}  // namespace fourdvt::measure
