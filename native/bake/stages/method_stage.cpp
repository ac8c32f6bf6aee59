// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bake/method/method_choice.h"
#include "bake/method/method_trial.h"
#include "bake/run/job.h"
#include "bake/stages/stages.h"
#include "base/bytes.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "render/cameras/camera_method.h"

namespace fourdvt::store {

// All fields except the cost, which is not measured.
void fields(Archive& a, bake::MethodScore& s) {
  a(s.method, s.psnr_db, s.ssim, s.own_psnr_db, s.psnr_fg_db, s.ssim_fg);
}
void fields(Archive& a, bake::TrialSums& s) { a(s.views, s.shift_px, s.gap_deg, s.scores); }

}  // namespace fourdvt::store

namespace fourdvt::bake {
namespace {

constexpr const char* kVersion = "methods 3";  // change it whenever stored sums of older builds must not be reused

struct Place {
  const capture::CaptureSequence* sequence;
  uint32_t frame;
};

// Trial frames, spread over all frames of all sequences.
std::vector<Place> placesOf(const Job& job) {
  const uint32_t count = std::min(kTrialFrames, job.total_frames);
  std::vector<Place> out;
  for (uint32_t i = 0; i < count; ++i) {
    uint64_t at = (2 * uint64_t(i) + 1) * job.total_frames / (2 * count);
    for (const capture::CaptureSequence& sequence : job.capture.sequences) {
      if (at < sequence.frame_count) {
        out.push_back({&sequence, uint32_t(at)});
        break;
      }
      at -= sequence.frame_count;
    }
  }
  return out;
}

// Methods that the device supports and whose cost is within the limit on any later surface.
Result<std::vector<std::string>> methodsOf(gpu::Device& device, const CameraOptions& options, size_t faces) {
  std::vector<std::string> out;
  for (const std::string& name : methodCandidates()) {
    if (methodCost(name, faces) > options.choice.most_cost) continue;
    const auto method = render::makeCameraMethod(device, name);
    if (method.ok())
      out.push_back(name);
    else if (method.error().id != ErrorId::Unsupported)
      return method.error();
  }
  return out;
}

std::string keyOf(const Job& job, const Place& place, const std::vector<std::string>& methods) {
  std::string key = kVersion;
  for (const std::string& method : methods) key += " " + method;
  for (const PinholeCamera& camera : job.cameras) key += " " + camera.name;
  key += " faces " + std::to_string(job.options.cameras.faces) + " colours " +
         std::to_string(job.options.colour_calibration) + " " + place.sequence->name + " " +
         std::to_string(place.frame);
  return key + captureKey(job, *place.sequence);
}

Result<TrialSums> measure(BakeRun& run, const std::vector<ColourMap>& maps, const Place& place,
                          const std::vector<std::string>& methods) {
  const Job& job = run.job;
  FOURDVT_ASSIGN(const auto reader,
                 mattes::FrameReader::open(job.capture, *place.sequence, run.environment.open_video, place.frame));
  FOURDVT_ASSIGN(auto captured, reader->next());
  for (size_t c = 0; c < maps.size(); ++c) applyColours(maps[c], captured.pictures[c]);
  const TriangleMesh surface = streamedSurface(job, captured);
  const TrialFrame frame{job.cameras, surface, captured.pictures, job.length_scale};
  FOURDVT_ASSIGN(const auto drawing, FrameDrawing::create(run.device(), job.cameras, job.length_scale));
  FOURDVT_TRY(drawing->setFrame(surface, captured.pictures));
  return tryMethods(run.device(), *drawing, frame, trialCameras(frame), methods);
}

// Sums of one frame, from the survey folder or measured now.
Result<TrialSums> keptTrial(BakeRun& run, const std::vector<ColourMap>& maps, const Place& place,
                            const std::vector<std::string>& methods) {
  const std::string folder = run.job.surveyFolder(),
                    path = store::keyedPath(folder, "method", keyOf(run.job, place, methods));
  if (auto kept = store::load<TrialSums>(path)) return kept;
  FOURDVT_ASSIGN(auto sums, measure(run, maps, place, methods));
  FOURDVT_TRY(platform::makeFolder(folder));
  FOURDVT_TRY(store::save(path, sums));
  return sums;
}

// Note with the reason why nothing was measured.
std::string notMeasured(const Job& job) {
  const size_t cameras = job.cameras.size();
  const std::string why = cameras < 3 ? "leaving one of " + std::to_string(cameras) +
                                            (cameras == 1 ? " camera" : " cameras") + " out leaves none to blend"
                                      : "in no frame do cameras on both sides of one that is left out see the surface";
  return std::string("The method was not measured: ") + why + "; it is " + kUnmeasuredMethod +
         ", --method NAME sets another.";
}

// Faces of a frame as it will be streamed.
Result<size_t> streamedFaces(const Job& job) {
  FOURDVT_ASSIGN(const auto first, capture::readSurfaceFrame(job.capture, job.capture.sequences[0], 0));
  const auto most = size_t(job.options.cameras.faces);
  return job.oneTopology() || most == 0 ? first.faces.size() : std::min(first.faces.size(), most);
}

Result<TrialSums> tryPlaces(BakeRun& run, const std::vector<ColourMap>& maps, size_t faces, ChosenMethod& out) {
  const Job& job = run.job;
  const auto places = placesOf(job);
  StageProgress progress(run.progress, infoOf(Stage::Method).work_s * double(places.size()));
  FOURDVT_ASSIGN(const auto methods, methodsOf(run.device(), job.options.cameras, faces));
  TrialSums all;
  for (const Place& place : places) {
    progress.done(double(out.frames) / double(places.size()),
                  "method " + std::to_string(out.frames) + "/" + std::to_string(places.size()));
    FOURDVT_TRY(run.checkStop("tried frames", job.surveyFolder()));
    FOURDVT_ASSIGN(const auto sums, keptTrial(run, maps, place, methods));
    ++out.frames;
    add(sums, all);
  }
  return all;
}

}  // namespace

uint32_t triedFrames(const Job& job) {
  if (!job.options.cameras.method.empty() || job.cameras.size() < 3) return 0;
  return std::min(kTrialFrames, job.total_frames);
}

std::pair<size_t, uint32_t> triedFrame(const Job& job, uint32_t number) {
  const Place place = placesOf(job).at(number);
  return {size_t(place.sequence - job.capture.sequences.data()), place.frame};
}

Status tryMethodsOn(BakeRun& run, const std::vector<ColourMap>& maps, uint32_t number) {
  StageClock::Span span(run.clock, Stage::Method);
  FOURDVT_ASSIGN(const size_t faces, streamedFaces(run.job));
  FOURDVT_ASSIGN(const auto methods, methodsOf(run.device(), run.job.options.cameras, faces));
  FOURDVT_ASSIGN([[maybe_unused]] const auto sums, keptTrial(run, maps, placesOf(run.job).at(number), methods));
  return {};
}

Result<ChosenMethod> chooseBakedMethod(BakeRun& run, const std::vector<ColourMap>& maps) {
  Job& job = run.job;
  ChosenMethod out;
  out.method = job.options.cameras.method;
  if (!out.method.empty()) return out;
  StageClock::Span span(run.clock, Stage::Method);
  FOURDVT_ASSIGN(const size_t faces, streamedFaces(job));
  TrialSums all;
  if (triedFrames(job) > 0) {
    FOURDVT_ASSIGN(all, tryPlaces(run, maps, faces, out));
  }
  out.views = all.views;
  if (all.views > 0) {
    const LeftOut views = meanViews(all);
    out.shift_px = views.shift_px;
    out.gap_deg = views.gap_deg;
    out.most_cost = job.options.cameras.choice.most_cost;
    out.choice = chooseMethod(meanScores(all, faces), views, job.options.cameras.choice);
    out.method = out.choice.method;
  }
  if (!out.method.empty()) return out;
  out.method = kUnmeasuredMethod;
  job.notes.push_back(notMeasured(job));
  if (run.environment.note) run.environment.note(job.notes.back());
  return out;
}

}  // namespace fourdvt::bake
