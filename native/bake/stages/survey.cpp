// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/survey.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <future>

#include "bake/run/record_file.h"
#include "bake/run/survey_files.h"
#include "bake/stages/validate.h"
#include "package/character.h"
#include "platform/files.h"
#include "platform/folders.h"

namespace fourdvt::bake {
namespace {

constexpr uint32_t kHysteresisFrames = 2;  // to each side
// Colours are compared in every kColourEvery-th of the first kColourFrames frames of a sequence.
constexpr uint32_t kColourEvery = 4, kColourFrames = 32;
constexpr double kMeasuringShare = 0.8;  // of the survey's time; the rest is labelling

bool showsColours(uint32_t frame) { return frame < kColourFrames && frame % kColourEvery == 0; }

struct SurveyFrame {
  Positions positions;  // decoded order
  std::vector<PictureCrop> crops;
  std::vector<Image> pictures;  // only where colours are compared
};

Status checkStop(const BakeEnvironment& environment, const std::string& folder) {
  if (!environment.stop || !*environment.stop) return {};
  return Error{ErrorId::Interrupted,
               "stopped; what was measured is kept in " + folder + "; run the same command with --resume to go on"};
}

Status checkVisible(const Job& job, const SequencePlan& plan, const Positions& positions,
                    const std::vector<float>& fractions) {
  for (float f : fractions)
    if (f >= FaceCostOptions().fallback_fraction) return {};
  glm::vec3 low = positions[0], high = low;
  for (const glm::vec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
  const glm::dvec3 centre(0.5f * (low + high));
  double distance = 0;
  for (const PinholeCamera& camera : job.cameras) distance += glm::length(camera.centreInWorld() - centre);
  char text[400];
  std::snprintf(
      text, sizeof text,
      ": no camera sees any face of frame 0. The mesh spans (%.3g, %.3g, %.3g) to (%.3g, %.3g, %.3g) m and the "
      "cameras are %.3g m away on average: check the axes and units of meshes and cameras, and the mattes",
      low.x, low.y, low.z, high.x, high.y, high.z, distance / job.cameras.size());
  return Error{ErrorId::NothingVisible, plan.source->folder + text};
}

}  // namespace

Survey::Survey(const Job& job)
    : job_(&job),
      folder_(job.options.survey_folder.empty() ? job.workFolder() + "/survey" : job.options.survey_folder) {
  std::string all;
  for (const SequencePlan& plan : job.sequences) {
    const std::string& name = plan.source->name;
    const std::string key = captureKey(job, plan);
    all += key;
    paths_[name] = {keyedPath(folder_, "visible_" + name, key),
                    keyedPath(folder_, "labels_" + name, key + labelKey(job.options))};
  }
  colours_path_ = keyedPath(folder_, "colours", all);
}

Result<Survey> Survey::run(const Job& job, const BakeEnvironment& environment, StageClock& clock,
                           const OnProgress& on_progress) {
  Survey survey(job);
  FOURDVT_TRY(platform::makeFolder(survey.folder_));
  FOURDVT_TRY(survey.measure(environment, clock, on_progress));
  uint32_t before = 0;
  for (const SequencePlan& plan : job.sequences) {
    const auto tell = [&](uint32_t frames) {
      on_progress("labels " + plan.source->name,
                  kMeasuringShare + (1 - kMeasuringShare) * (before + frames) / job.total_frames);
    };
    if (!survey.loadStatistics(plan)) FOURDVT_TRY(survey.label(plan, environment, clock, tell));
    before += plan.source->frame_count;
  }
  return survey;
}

Status Survey::measure(const BakeEnvironment& environment, StageClock& clock, const OnProgress& on_progress) {
  const bool need_colours = job_->options.colour_calibration && job_->cameras.size() > 1 && !loadColours();
  ColourCalibrator calibrator(job_->cameras.size());
  std::unique_ptr<FrameBaker> baker;
  uint32_t before = 0;
  for (const SequencePlan& plan : job_->sequences) {
    const uint32_t frames = plan.source->frame_count;
    const bool measured = RecordFile::isComplete(fractionsPath(plan), fractionBytes(), frames);
    if (!measured || need_colours) {
      if (!baker) {
        auto made = FrameBaker::create(*environment.device, job_->cameras, job_->mesh.decoded.topology,
                                       job_->mesh.decoded.positions, {});
        if (!made) return made.error();
        baker = made.take();
      }
      const auto tell = [&](uint32_t done) {
        on_progress("survey " + plan.source->name + " " + std::to_string(done) + "/" + std::to_string(frames),
                    kMeasuringShare * (before + done) / job_->total_frames);
      };
      FOURDVT_TRY(measureSequence(plan, *baker, environment, clock, need_colours ? &calibrator : nullptr, tell));
    }
    before += frames;
  }
  if (!need_colours) return {};
  StageClock::Span span(clock, "colours");
  colour_maps_ = calibrator.solve();
  return saveColours();
}

Status Survey::measureSequence(const SequencePlan& plan, FrameBaker& baker, const BakeEnvironment& environment,
                               StageClock& clock, ColourCalibrator* calibrator,
                               const std::function<void(uint32_t)>& on_frame) {
  auto file = RecordFile::resume(fractionsPath(plan), fractionBytes(), plan.source->frame_count);
  if (!file) return file.error();
  const uint32_t known = file.value().count();
  const uint32_t first = calibrator ? 0 : known;
  const uint32_t end =
      known < plan.source->frame_count ? plan.source->frame_count : std::min(plan.source->frame_count, kColourFrames);
  auto reader = capture::FrameReader::open(job_->capture, *plan.source, environment.open_video, first);
  if (!reader) return reader.error();
  const auto read = [&, calibrator](uint32_t f) -> Result<SurveyFrame> {
    StageClock::Span span(clock, "decode");
    auto frame = reader.value()->next();
    if (!frame) return frame.error();
    SurveyFrame out;
    out.positions = reordered(job_->mesh, frame.value().positions);
    if (f >= known)
      for (size_t c = 0; c < job_->cameras.size(); ++c)
        out.crops.push_back(cropPicture(job_->cameras[c], out.positions, frame.value().pictures[c]));
    if (calibrator && showsColours(f)) out.pictures = std::move(frame.value().pictures);
    return out;
  };
  const std::launch lane = job_->options.jobs > 1 ? std::launch::async : std::launch::deferred;
  std::future<Result<SurveyFrame>> next = std::async(lane, read, first);  // joins on every way out
  for (uint32_t f = first; f < end; ++f) {
    auto frame = next.get();
    if (!frame) return frame.error();
    FOURDVT_TRY(checkStop(environment, folder_));
    if (f + 1 < end) next = std::async(lane, read, f + 1);
    if (f >= known) {
      StageClock::Span span(clock, "visibility");
      baker.setFrame(frame.value().positions, frame.value().crops);
      auto shares = baker.measureVisibility();
      if (!shares) return shares.error();
      if (f == 0) FOURDVT_TRY(checkVisible(*job_, plan, frame.value().positions, shares.value()));
      std::vector<uint8_t> record;
      for (float share : shares.value()) record.push_back(static_cast<uint8_t>(share * 255 + 0.5f));
      FOURDVT_TRY(file.value().append(record));
    }
    if (!frame.value().pictures.empty()) {
      auto shares = file.value().read(f);
      if (!shares) return shares.error();
      StageClock::Span span(clock, "colours");
      std::vector<float> fractions;
      for (uint8_t share : shares.value()) fractions.push_back(share / 255.0f);
      calibrator->add(job_->cameras, job_->mesh.decoded.topology, frame.value().positions, fractions,
                      frame.value().pictures);
    }
    on_frame(f + 1);
  }
  return file.value().finish();
}

Status Survey::label(const SequencePlan& plan, const BakeEnvironment& environment, StageClock& clock,
                     const std::function<void(uint32_t)>& on_frame) {
  StageClock::Span span(clock, "labels");
  const std::string path = labelsPath(plan);
  platform::removeFolder(path + ".part");
  auto file = RecordFile::resume(path, labelBytes(), plan.source->frame_count);
  if (!file) return file.error();
  LabelOptions options;
  options.mode = job_->options.labels;
  options.layers = job_->options.layers;
  options.jobs = job_->options.jobs;
  auto statistics = solveLabels(
      options, makeFaceGraph(job_->mesh.decoded.topology), plan.source->frame_count,
      [&](uint32_t frame) { return faceCosts(plan, frame); },
      [&](uint32_t, const std::vector<uint8_t>& labels) { return file.value().append(labels); }, on_frame,
      environment.stop);
  if (!statistics) {
    if (statistics.error().id == ErrorId::Interrupted) FOURDVT_TRY(checkStop(environment, folder_));
    return statistics.error();
  }
  FOURDVT_TRY(platform::writeFileAtomic(path + ".statistics", statisticsBytes(statistics.value())));
  FOURDVT_TRY(file.value().finish());
  statistics_[plan.source->name] = statistics.take();
  return {};
}

bool Survey::loadStatistics(const SequencePlan& plan) {
  if (!RecordFile::isComplete(labelsPath(plan), labelBytes(), plan.source->frame_count)) return false;
  auto bytes = platform::readFile(labelsPath(plan) + ".statistics");
  LabelStatistics statistics;
  if (!bytes || !statisticsFrom(bytes.value(), statistics)) {
    std::error_code ignored;
    std::filesystem::remove(labelsPath(plan), ignored);
    return false;
  }
  statistics_[plan.source->name] = statistics;
  return true;
}

Result<std::vector<float>> Survey::fractions(const SequencePlan& plan, uint32_t frame) const {
  auto record = RecordFile::readOne(fractionsPath(plan), fractionBytes(), frame);
  if (!record) return record.error();
  std::vector<float> out;
  out.reserve(record.value().size());
  for (uint8_t share : record.value()) out.push_back(share / 255.0f);
  return out;
}

Result<FaceCosts> Survey::faceCosts(const SequencePlan& plan, uint32_t frame) const {
  const uint32_t first = frame - std::min(frame, kHysteresisFrames);
  const uint32_t last = std::min(frame + kHysteresisFrames, plan.source->frame_count - 1);
  std::vector<std::vector<float>> window;
  for (uint32_t f = first; f <= last; ++f) {
    auto record = fractions(plan, f);
    if (!record) return record.error();
    window.push_back(record.take());
  }
  FaceCostOptions options;
  options.penalty = job_->options.penalty;
  const std::vector<float> steady = steadyFractions(window, frame - first, options);
  auto positions = capture::readMeshFrame(job_->capture, *plan.source, frame);
  if (!positions) return positions.error();
  return measureFaceCosts(options, job_->cameras, job_->mesh.decoded.topology, reordered(job_->mesh, positions.value()),
                          steady);
}

Result<std::vector<uint8_t>> Survey::labels(const SequencePlan& plan, uint32_t frame) const {
  return RecordFile::readOne(labelsPath(plan), labelBytes(), frame);
}

Result<std::vector<uint8_t>> Survey::penaltyOrder(const SequencePlan& plan, uint32_t frame) const {
  auto costs = faceCosts(plan, frame);
  if (!costs) return costs.error();
  const size_t faces = job_->mesh.decoded.topology.faceCount(), cameras = job_->cameras.size();
  std::vector<uint8_t> order(cameras * faces, package::kNoCamera);
  std::vector<uint8_t> list;
  for (size_t f = 0; f < faces; ++f) {
    list.clear();
    for (size_t c = 0; c < cameras; ++c)
      if (costs.value().feasible[f] >> c & 1) list.push_back(static_cast<uint8_t>(c));
    const float* penalty = &costs.value().penalty[f * cameras];
    std::stable_sort(list.begin(), list.end(), [&](uint8_t a, uint8_t b) { return penalty[a] < penalty[b]; });
    for (size_t r = 0; r < list.size(); ++r) order[r * faces + f] = list[r];
  }
  return order;
}

bool Survey::loadColours() {
  auto bytes = platform::readFile(colours_path_);
  std::vector<ColourMap> maps(job_->cameras.size());
  if (!bytes || !coloursFrom(bytes.value(), maps)) return false;
  colour_maps_ = std::move(maps);
  return true;
}

Status Survey::saveColours() const { return platform::writeFileAtomic(colours_path_, coloursBytes(colour_maps_)); }

}  // namespace fourdvt::bake
