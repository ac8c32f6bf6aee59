// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/survey.h"

#include <algorithm>
#include <filesystem>
#include <future>

#include "bake/run/job.h"
#include "bake/stages/stages.h"
#include "base/text.h"
#include "mattes/frame_reader.h"
#include "package/character.h"
#include "platform/files.h"
#include "store/record_file.h"

namespace fourdvt::store {

void fields(Archive& a, bake::LabelStatistics& s) {
  a(s.frames, s.seam_percent, s.flip_percent, s.camera_seam_percent, s.camera_flip_percent, s.seen_seam_percent,
    s.seen_flip_percent, s.mean_penalty, s.energy, s.empty_percent, s.seconds);
}

}  // namespace fourdvt::store

namespace fourdvt::bake {
namespace {

constexpr const char* kWindow = ".window-";
constexpr const char* kKept = "visibility and labels measured so far";
constexpr double kMeasuringShare = 0.8;  // share of the survey's time; labelling takes the rest

bool showsColours(uint32_t frame) { return frame < kColourFrames && frame % kColourEvery == 0; }

struct SurveyFrame {
  Positions positions;  // in the decoded mesh's order
  std::vector<PictureCrop> crops;
  std::vector<Image> pictures;  // empty unless colours are compared in this frame
};

Status checkVisible(const Job& job, const capture::CaptureSequence& sequence, const Positions& positions,
                    const std::vector<float>& fractions) {
  for (float f : fractions)
    if (f >= FaceCostOptions().fallback_fraction) return {};
  const auto [low, high] = boundsOf(positions);
  const glm::dvec3 centre(0.5f * (low + high));
  double distance = 0;
  for (const PinholeCamera& camera : job.cameras) distance += glm::length(camera.centreInWorld() - centre);
  const std::string text = printed(
      ": no camera sees any face of frame 0. The mesh spans (%.3g, %.3g, %.3g) to (%.3g, %.3g, %.3g) m and the "
      "cameras are %.3g m away on average: check the axes and units of meshes and cameras, and the mattes",
      low.x, low.y, low.z, high.x, high.y, high.z, distance / job.cameras.size());
  return Error{ErrorId::NothingVisible, sequence.folder + text};
}

LabelOptions labelOptions(const Job& job) {
  LabelOptions options;
  options.rule = job.options.labels;
  options.layers = job.options.layers;
  options.jobs = job.options.jobs;
  return options;
}

}  // namespace

LabelKeeper windowKeeper(const std::string& labels_path) {
  const auto pathOf = [labels_path](uint32_t first, uint32_t end) {
    return labels_path + kWindow + std::to_string(first) + "-" + std::to_string(end - 1);
  };
  return {[pathOf](uint32_t first, uint32_t end) {
            auto kept = store::load<store::Bytes>(pathOf(first, end));
            return kept ? kept.take() : store::Bytes();
          },
          [pathOf](uint32_t first, uint32_t end, const store::Bytes& bytes) {
            return store::save(pathOf(first, end), bytes);
          }};
}

void removeWindows(const std::string& labels_path) {
  const std::filesystem::path labels(labels_path);
  const std::string start = labels.filename().string() + kWindow;
  platform::removeEntries(labels.parent_path().string(),
                          [&](const std::string& name) { return name.starts_with(start); });
}

Survey::Survey(const Job& job) : job_(&job), folder_(job.surveyFolder()) {
  std::string all;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    const std::string& name = sequence.name;
    const std::string key = captureKey(job, sequence);
    all += key;
    paths_[name] = {store::keyedPath(folder_, "visible_" + name, key),
                    store::keyedPath(folder_, "labels_" + name, key + labelKey(job.options))};
  }
  colours_path_ = store::keyedPath(folder_, "colours", all);
}

Result<Survey> Survey::open(BakeRun& run) {
  Survey survey(run.job);
  FOURDVT_TRY(platform::makeFolder(survey.folder_));
  if (auto maps = store::load<std::vector<ColourMap>>(survey.colours_path_);
      maps && maps.value().size() == run.job.cameras.size())
    survey.colour_maps_ = maps.take();
  return survey;
}

Result<Survey> Survey::make(BakeRun& run) {
  FOURDVT_ASSIGN(Survey survey, open(run));
  StageProgress progress(run.progress, infoOf(Stage::Visibility).work_s * run.job.total_frames);
  FOURDVT_TRY(survey.measure(run, progress));
  uint32_t before = 0;
  for (const capture::CaptureSequence& sequence : run.job.capture.sequences) {
    const auto tell = [&](uint32_t frames) {
      progress.done(kMeasuringShare + (1 - kMeasuringShare) * (before + frames) / run.job.total_frames,
                    "labels " + sequence.name);
    };
    if (!survey.loadStatistics(sequence)) FOURDVT_TRY(survey.label(run, sequence, tell));
    before += sequence.frame_count;
  }
  return survey;
}

Status Survey::measure(BakeRun& run, StageProgress& progress) {
  const bool need_colours = matchesColours() && colour_maps_.empty();
  ColourCalibrator calibrator(job_->cameras.size());
  Measuring measuring;
  if (need_colours) measuring.calibrator = &calibrator;
  uint32_t before = 0;
  for (const capture::CaptureSequence& sequence : job_->capture.sequences) {
    measuring.on_frame = [&](uint32_t done) {
      progress.done(
          kMeasuringShare * (before + done) / job_->total_frames,
          "survey " + sequence.name + " " + std::to_string(done) + "/" + std::to_string(sequence.frame_count));
    };
    FOURDVT_TRY(measureSequence(run, sequence, measuring));
    before += sequence.frame_count;
  }
  return need_colours ? keepColours(run, calibrator) : Status();
}

Status Survey::keepColours(BakeRun& run, const ColourCalibrator& calibrator) {
  StageClock::Span span(run.clock, Stage::Colours);
  colour_maps_ = calibrator.solve();
  return store::save(colours_path_, colour_maps_);
}

Status Survey::measureFrom(BakeRun& run, const capture::CaptureSequence& sequence, uint32_t first) {
  Measuring measuring;
  const Window window = windowOf(sequence, first);
  return isMeasured(sequence, window) ? Status() : measureWindow(run, sequence, window, measuring);
}

Status Survey::matchColours(BakeRun& run) {
  if (!matchesColours() || !colour_maps_.empty()) return {};
  ColourCalibrator calibrator(job_->cameras.size());
  for (const capture::CaptureSequence& sequence : job_->capture.sequences) {
    Measuring measuring;
    measuring.calibrator = &calibrator;
    for (uint32_t first = 0; first < std::min(kColourFrames, sequence.frame_count);) {
      const Window window = windowOf(sequence, first);
      first = window.end;
      if (showsColours(window)) FOURDVT_TRY(measureWindow(run, sequence, window, measuring));
    }
  }
  return keepColours(run, calibrator);
}

Survey::Window Survey::windowOf(const capture::CaptureSequence& sequence, uint32_t frame) const {
  const auto frames = static_cast<uint32_t>(job_->options.survey_window_frames);
  const uint32_t first = frame / frames * frames;
  return {first, std::min(first + frames, sequence.frame_count)};
}

std::string Survey::fractionsPath(const capture::CaptureSequence& sequence, const Window& window) const {
  return paths_.at(sequence.name).fractions + "." + std::to_string(window.first) + "-" + std::to_string(window.end - 1);
}

bool Survey::showsColours(const Window& window) {
  for (uint32_t f = window.first; f < window.end; ++f)
    if (bake::showsColours(f)) return true;
  return false;
}

bool Survey::isMeasured(const capture::CaptureSequence& sequence, const Window& window) const {
  return store::RecordFile::isComplete(fractionsPath(sequence, window), fractionBytes(), window.count());
}

Status Survey::measureSequence(BakeRun& run, const capture::CaptureSequence& sequence, Measuring& measuring) {
  measuring.reader.reset();
  for (uint32_t first = 0; first < sequence.frame_count;) {
    const Window window = windowOf(sequence, first);
    first = window.end;
    if (isMeasured(sequence, window) && !(measuring.calibrator && showsColours(window))) {
      measuring.reader.reset();
      continue;
    }
    FOURDVT_TRY(measureWindow(run, sequence, window, measuring));
  }
  return {};
}

Status Survey::measureWindow(BakeRun& run, const capture::CaptureSequence& sequence, const Window& window,
                             Measuring& measuring) {
  ColourCalibrator* const calibrator = showsColours(window) ? measuring.calibrator : nullptr;
  FOURDVT_ASSIGN(auto file, store::RecordFile::resume(fractionsPath(sequence, window), fractionBytes(), window.count(),
                                                      run.environment.writer));
  const uint32_t known = window.first + file.count();
  const uint32_t first = calibrator ? window.first : known;
  if (known < window.end && !measuring.baker) {
    const package::BaseMesh& mesh = job_->mesh.decoded;
    FOURDVT_ASSIGN(measuring.baker, FrameBaker::create(run.device(), job_->cameras, mesh.topology, mesh.positions,
                                                       {.length_scale = float(job_->length_scale)}));
  }
  if (measuring.reader) {
    measuring.reader->skipTo(first);
  } else {
    FOURDVT_ASSIGN(measuring.reader,
                   mattes::FrameReader::open(job_->capture, sequence, run.environment.open_video, first));
  }
  const auto needed = [&, calibrator](uint32_t f) {  // the first frame from f on that is measured
    while (f < std::min(known, window.end) && !(calibrator && bake::showsColours(f))) ++f;
    return f;
  };
  const auto read = [&, calibrator](uint32_t f) -> Result<SurveyFrame> {
    StageClock::Span clock(run.clock, Stage::Decode);
    measuring.reader->skipTo(f);
    FOURDVT_ASSIGN(auto frame, measuring.reader->next());
    SurveyFrame out;
    out.positions = reordered(job_->mesh, frame.positions);
    if (f >= known)
      for (size_t c = 0; c < job_->cameras.size(); ++c)
        out.crops.push_back(cropPicture(job_->cameras[c], out.positions, frame.pictures[c]));
    if (calibrator && bake::showsColours(f)) out.pictures = std::move(frame.pictures);
    return out;
  };
  std::future<Result<SurveyFrame>> next;  // its destructor joins on every return
  const uint32_t begin = needed(first);
  if (begin < window.end) next = std::async(run.lane(), read, begin);
  for (uint32_t f = begin, after = 0; f < window.end; f = after) {
    after = needed(f + 1);
    FOURDVT_ASSIGN(auto frame, next.get());
    FOURDVT_TRY(run.checkStop(kKept, folder_));
    if (after < window.end) next = std::async(run.lane(), read, after);
    if (f >= known) {
      StageClock::Span clock(run.clock, Stage::Visibility);
      measuring.baker->setFrame(frame.positions, frame.crops);
      FOURDVT_ASSIGN(auto shares, measuring.baker->measureVisibility());
      if (f == 0) FOURDVT_TRY(checkVisible(*job_, sequence, frame.positions, shares));
      std::vector<uint8_t> record;
      for (float share : shares) record.push_back(static_cast<uint8_t>(share * 255 + 0.5f));
      FOURDVT_TRY(file.append(record));
    }
    if (!frame.pictures.empty()) {
      FOURDVT_ASSIGN(auto shares, file.read(f - window.first));
      StageClock::Span clock(run.clock, Stage::Colours);
      std::vector<float> fractions;
      for (uint8_t share : shares) fractions.push_back(share / 255.0f);
      calibrator->add(job_->cameras, job_->mesh.decoded.topology, frame.positions, fractions, frame.pictures);
    }
    if (measuring.on_frame) measuring.on_frame(f + 1);
  }
  return file.finish();
}

std::vector<LabelWindow> planLabelWindows(const Job& job, const capture::CaptureSequence& sequence) {
  return planWindows(labelOptions(job), sequence.frame_count);
}

Status Survey::withLabelExchange(BakeRun& run, const capture::CaptureSequence& sequence, const OnFrame& on_frame,
                                 const LabelSink& sink, const LabelSolve& solve) {
  StageClock::Span span(run.clock, Stage::Labels);
  const LabelKeeper keeper = windowKeeper(labelsPath(sequence));
  const Status solved = solve(
      labelOptions(*job_), makeFaceGraph(job_->mesh.decoded.topology),
      {[&](uint32_t frame) { return faceCosts(sequence, frame); }, sink, on_frame, run.environment.stop, &keeper});
  if (!solved.ok() && solved.error().id == ErrorId::Interrupted) FOURDVT_TRY(run.checkStop(kKept, folder_));
  return solved;
}

Status Survey::labelWindows(BakeRun& run, const capture::CaptureSequence& sequence,
                            const std::vector<size_t>& windows) {
  if (isLabelled(sequence)) return {};
  return withLabelExchange(run, sequence, {}, {},
                           [&](const LabelOptions& options, const FaceGraph& graph, const LabelExchange& exchange) {
                             return solveLabelWindows(options, graph, sequence.frame_count, windows, exchange);
                           });
}

Status Survey::labelSequence(BakeRun& run, const capture::CaptureSequence& sequence) {
  return isLabelled(sequence) ? Status() : label(run, sequence, {});
}

Status Survey::label(BakeRun& run, const capture::CaptureSequence& sequence, const OnFrame& on_frame) {
  const std::string path = labelsPath(sequence);
  FOURDVT_ASSIGN(auto file, store::RecordFile::begin(path, labelBytes(), sequence.frame_count, run.environment.writer));
  LabelStatistics statistics;
  FOURDVT_TRY(withLabelExchange(
      run, sequence, on_frame, [&](uint32_t, const std::vector<uint8_t>& labels) { return file.append(labels); },
      [&](const LabelOptions& options, const FaceGraph& graph, const LabelExchange& exchange) -> Status {
        FOURDVT_ASSIGN(statistics, solveLabels(options, graph, sequence.frame_count, exchange));
        return {};
      }));
  FOURDVT_TRY(store::save(path + ".statistics", statistics));
  FOURDVT_TRY(file.finish());
  if (run.environment.writer.empty()) removeWindows(path);
  statistics_[sequence.name] = std::move(statistics);
  return {};
}

bool Survey::loadStatistics(const capture::CaptureSequence& sequence) {
  if (!store::RecordFile::isComplete(labelsPath(sequence), labelBytes(), sequence.frame_count)) return false;
  auto kept = store::load<LabelStatistics>(labelsPath(sequence) + ".statistics");
  if (kept) statistics_[sequence.name] = kept.take();
  return kept.ok();
}

Result<std::vector<float>> Survey::fractions(const capture::CaptureSequence& sequence, uint32_t frame) const {
  const Window window = windowOf(sequence, frame);
  FOURDVT_ASSIGN(auto record,
                 store::RecordFile::readOne(fractionsPath(sequence, window), fractionBytes(), frame - window.first));
  std::vector<float> out;
  out.reserve(record.size());
  for (uint8_t share : record) out.push_back(share / 255.0f);
  return out;
}

Result<FaceCosts> Survey::faceCosts(const capture::CaptureSequence& sequence, uint32_t frame) const {
  const uint32_t first = frame - std::min(frame, kHysteresisFrames);
  const uint32_t last = std::min(frame + kHysteresisFrames, sequence.frame_count - 1);
  std::vector<std::vector<float>> window;
  for (uint32_t f = first; f <= last; ++f) {
    FOURDVT_ASSIGN(auto record, fractions(sequence, f));
    window.push_back(std::move(record));
  }
  FaceCostOptions options;
  options.penalty = job_->options.penalty;
  const std::vector<float> steady = steadyFractions(window, frame - first, options);
  FOURDVT_ASSIGN(auto positions, capture::readMeshFrame(job_->capture, sequence, frame));
  return measureFaceCosts(options, job_->cameras, job_->mesh.decoded.topology, reordered(job_->mesh, positions),
                          steady);
}

Result<std::vector<uint8_t>> Survey::labels(const capture::CaptureSequence& sequence, uint32_t frame) const {
  return store::RecordFile::readOne(labelsPath(sequence), labelBytes(), frame);
}

Result<std::vector<uint8_t>> Survey::penaltyOrder(const capture::CaptureSequence& sequence, uint32_t frame) const {
  FOURDVT_ASSIGN(auto costs, faceCosts(sequence, frame));
  const size_t faces = job_->mesh.decoded.topology.faceCount(), cameras = job_->cameras.size();
  std::vector<uint8_t> order(cameras * faces, package::kNoCamera);
  std::vector<uint8_t> list;
  for (size_t f = 0; f < faces; ++f) {
    list.clear();
    for (size_t c = 0; c < cameras; ++c)
      if (costs.feasible[f] >> c & 1) list.push_back(static_cast<uint8_t>(c));
    const float* penalty = &costs.penalty[f * cameras];
    std::stable_sort(list.begin(), list.end(), [&](uint8_t a, uint8_t b) { return penalty[a] < penalty[b]; });
    for (size_t r = 0; r < list.size(); ++r) order[r * faces + f] = list[r];
  }
  return order;
}

}  // namespace fourdvt::bake
