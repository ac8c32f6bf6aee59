// SPDX-License-Identifier: Apache-2.0
// The recipe: validate → survey → every missing GOP, frame by frame → assemble. Three lanes overlap: reading the next
// frame, the GPU's stages of this one (on the calling thread, which owns the context), filling and encoding the one
// before.
#include "bake/bake.h"

#include <cmath>
#include <cstdio>
#include <future>

#include "bake/assemble.h"
#include "bake/frame_baker.h"
#include "bake/geometry.h"
#include "bake/output.h"
#include "bake/poster.h"
#include "bake/survey.h"
#include "bake/validate.h"

namespace fourdvt::bake {
namespace {

struct PreparedFrame {
  Positions positions;  // decoded order
  std::vector<PictureCrop> crops;
};

struct DrawnFrame {
  Positions positions;
  std::vector<uint8_t> labels;
  std::vector<Image> layers;
};

// The survey's share of the whole bake's time, for the progress line.
constexpr double kSurveyShare = 0.3;

using Now = std::chrono::steady_clock;

double secondsSince(Now::time_point start) { return std::chrono::duration<double>(Now::now() - start).count(); }

Progress progressAt(const Job& job, const std::string& stage, double share, Now::time_point started) {
  Progress p;
  p.stage = stage;
  p.total = job.total_frames;
  p.left_s = share > 0 ? secondsSince(started) * (1 - share) / share : 0;
  return p;
}

struct OpenGop {
  std::unique_ptr<GopEncoder> encoder;  // made with the first frame
  ChunkBuilder chunk;
};

class Baker {
 public:
  Baker(const Job& job, const Survey& survey, const BakeEnvironment& environment, StageClock& clock)
      : job_(job), survey_(survey), environment_(environment), clock_(clock) {}

  Status start();
  Status bakeMissing(const WorkFolder& work);
  uint32_t framesBaked() const { return baked_; }

 private:
  Status bakeGop(const WorkFolder& work, const SequencePlan& plan, uint32_t gop, capture::FrameReader& reader);
  Result<PreparedFrame> prepare(capture::FrameReader& reader);
  Result<DrawnFrame> drawFrame(const SequencePlan& plan, uint32_t index, PreparedFrame frame);
  Status finishFrame(const WorkFolder& work, OpenGop& open, DrawnFrame frame, uint32_t index, bool is_still);
  Status saveStill(const WorkFolder& work, const DrawnFrame& frame);
  Status waitForSave();
  bool stopped() const { return environment_.stop && *environment_.stop; }
  Status checkStop(const WorkFolder& work) const;  // Interrupted
  Status saveGop(const WorkFolder& work, OpenGop& open, const SequencePlan& plan, uint32_t gop);
  void reportProgress(const SequencePlan& plan, uint32_t frame);
  std::launch lane() const { return job_.options.jobs > 1 ? std::launch::async : std::launch::deferred; }

  const Job& job_;
  const Survey& survey_;
  const BakeEnvironment& environment_;
  StageClock& clock_;
  std::unique_ptr<FrameBaker> frames_;
  I420Picture picture_;
  std::future<Status> saving_;     // of the GOP before; ends before the next encoder is made: only one is in memory
  uint32_t done_ = 0, baked_ = 0;  // frames; done counts those of earlier runs
  Now::time_point started_ = Now::now();
};

Status Baker::start() {
  StageClock::Span span(clock_, "fill");  // the gutter maps are most of it
  FrameBakerOptions options;
  for (const package::Rect& rect : job_.layout.layers) options.layer_sizes.push_back(rect.width);
  options.gutter_texels = static_cast<float>(job_.options.gutter_texels);
  options.resample = job_.options.resample;
  if (job_.options.colour_calibration) options.colour_maps = survey_.colourMaps();
  const package::BaseMesh& mesh = job_.mesh.decoded;
  auto frames = FrameBaker::create(*environment_.device, job_.cameras, mesh.topology, mesh.positions, options);
  if (!frames) return frames.error();
  frames_ = frames.take();
  picture_ = I420Picture(job_.layout.width, job_.layout.height);
  return {};
}

Status Baker::bakeMissing(const WorkFolder& work) {
  for (size_t s = 0; s < job_.sequences.size(); ++s) {
    const SequencePlan& plan = job_.sequences[s];
    std::unique_ptr<capture::FrameReader> reader;  // stays open over neighbouring GOPs
    for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
      const uint32_t first = plan.gop_first_frames[g];
      if (work.hasGop(plan.source->name, g) && (s > 0 || g > 0 || work.hasStill())) {
        done_ += plan.gopEnd(g) - first;
        reader.reset();
        continue;
      }
      if (!reader) {
        auto opened = capture::FrameReader::open(job_.capture, *plan.source, environment_.open_video, first);
        if (!opened) return opened.error();
        reader = opened.take();
      }
      FOURDVT_TRY(bakeGop(work, plan, g, *reader));
      if (stopped()) FOURDVT_TRY(waitForSave());  // on every lane: a finished GOP is kept
      FOURDVT_TRY(checkStop(work));
    }
  }
  return waitForSave();
}

Status Baker::bakeGop(const WorkFolder& work, const SequencePlan& plan, uint32_t gop, capture::FrameReader& reader) {
  auto open = std::make_unique<OpenGop>(OpenGop{nullptr, ChunkBuilder(job_)});
  const uint32_t first = plan.gop_first_frames[gop], end = plan.gopEnd(gop);
  const auto read = [&] { return prepare(reader); };
  std::future<Result<PreparedFrame>> next = std::async(lane(), read);  // futures join on every way out
  std::future<Status> finished;
  for (uint32_t f = first; f < end; ++f) {
    auto prepared = next.get();
    if (!prepared) return prepared.error();
    if (f + 1 < end) next = std::async(lane(), read);
    auto drawn = drawFrame(plan, f, prepared.take());
    if (!drawn) return drawn.error();
    FOURDVT_TRY(f == first ? waitForSave() : finished.get());
    const bool is_still = f == 0 && &plan == job_.sequences.data();
    finished = std::async(lane(), [this, &work, &open, f, is_still, frame = drawn.take()]() mutable {
      return finishFrame(work, *open, std::move(frame), f, is_still);
    });
    reportProgress(plan, f + 1);
    if (f + 1 < end) FOURDVT_TRY(checkStop(work));
  }
  FOURDVT_TRY(finished.get());
  saving_ =
      std::async(lane(), [this, &work, &plan, gop, open = std::move(open)] { return saveGop(work, *open, plan, gop); });
  return {};
}

Status Baker::checkStop(const WorkFolder& work) const {
  if (!stopped()) return {};
  return Error{ErrorId::Interrupted,
               "stopped; finished GOPs are kept in " + work.path() + "; run the same command with --resume to go on"};
}

Status Baker::waitForSave() { return saving_.valid() ? saving_.get() : Status(); }

Result<PreparedFrame> Baker::prepare(capture::FrameReader& reader) {
  StageClock::Span span(clock_, "decode");
  auto frame = reader.next();
  if (!frame) return frame.error();
  PreparedFrame out;
  out.positions = reordered(job_.mesh, frame.value().positions);
  for (size_t c = 0; c < job_.cameras.size(); ++c)
    out.crops.push_back(cropPicture(job_.cameras[c], out.positions, frame.value().pictures[c]));
  return out;
}

Result<DrawnFrame> Baker::drawFrame(const SequencePlan& plan, uint32_t index, PreparedFrame frame) {
  DrawnFrame out;
  auto labels = survey_.labels(plan, index);
  if (!labels) return labels.error();
  out.labels = labels.take();
  StageClock::Span span(clock_, "resample");
  frames_->setFrame(frame.positions, frame.crops);
  if (job_.options.labels == LabelMode::PerTexel) {
    auto order = survey_.penaltyOrder(plan, index);
    if (!order) return order.error();
    auto layers = frames_->resamplePerTexel(order.value());
    if (!layers) return layers.error();
    out.layers = layers.take();
  } else {
    auto layers = frames_->resample(out.labels);
    if (!layers) return layers.error();
    out.layers = layers.take();
  }
  out.positions = std::move(frame.positions);
  return out;
}

Status Baker::finishFrame(const WorkFolder& work, OpenGop& open, DrawnFrame frame, uint32_t index, bool is_still) {
  {
    StageClock::Span span(clock_, "fill");
    frames_->fill(frame.layers);
  }
  {
    StageClock::Span span(clock_, "tile");
    tileFrame(job_.layout, frame.layers, index, picture_);
  }
  open.chunk.add(frame.positions, frame.labels);
  if (is_still) FOURDVT_TRY(saveStill(work, frame));
  StageClock::Span span(clock_, "encode");
  if (!open.encoder) {
    auto encoder = GopEncoder::create(job_.encode);
    if (!encoder) return encoder.error();
    open.encoder = encoder.take();
  }
  return open.encoder->push(picture_.view());
}

Status Baker::saveStill(const WorkFolder& work, const DrawnFrame& frame) {
  StageClock::Span span(clock_, "assemble");
  auto texture = encodePicture(rgbFromTile(picture_.view(), job_.layout.layers[0]), ".jpg", 90);
  if (!texture) return texture.error();
  const Image tiles = rgbFromTile(picture_.view(), {0, 0, picture_.width, picture_.height});
  auto tile_jpeg = encodePicture(tiles, ".jpg", 80);
  if (!tile_jpeg) return tile_jpeg.error();
  return work.saveStill({picture_, frame.labels, texture.take(), tile_jpeg.take()});
}

Status Baker::saveGop(const WorkFolder& work, OpenGop& open, const SequencePlan& plan, uint32_t gop) {
  GopArtefact artefact;
  {
    StageClock::Span span(clock_, "encode");
    auto video = open.encoder->finish();
    if (!video) return video.error();
    artefact.video = video.take();
    open.encoder.reset();
  }
  StageClock::Span span(clock_, "geometry");
  auto chunk = open.chunk.finish();
  if (!chunk) return chunk.error();
  artefact.chunk = chunk.take();
  return work.saveGop(plan.source->name, gop, artefact);
}

void Baker::reportProgress(const SequencePlan& plan, uint32_t frame) {
  ++done_;
  ++baked_;
  if (!environment_.progress) return;
  const double elapsed = secondsSince(started_);
  Progress p;
  p.stage = plan.source->name + " " + std::to_string(frame) + "/" + std::to_string(plan.source->frame_count);
  p.done = done_;
  p.total = job_.total_frames;
  p.frames_per_s = elapsed > 0 ? baked_ / elapsed : 0;
  p.left_s = p.frames_per_s > 0 ? (p.total - p.done) / p.frames_per_s : 0;
  environment_.progress(p);
}

Result<BakeReport> runJob(const Job& job, const BakeEnvironment& environment, StageClock& clock,
                          Now::time_point started) {
  auto work = WorkFolder::open(job.workFolder(), settingsKey(job), job.options.resume);
  if (!work) return work.error();
  ReportInput report;
  const auto tell = [&](const std::string& stage, double share) {
    if (environment.progress) environment.progress(progressAt(job, stage, share * kSurveyShare, started));
  };
  auto survey = Survey::run(job, environment, clock, tell);
  if (!survey) return survey.error();
  {
    Baker baker(job, survey.value(), environment, clock);
    FOURDVT_TRY(baker.start());
    FOURDVT_TRY(baker.bakeMissing(work.value()));
    report.resumed = baker.framesBaked() < job.total_frames;
  }
  {
    StageClock::Span span(clock, "assemble");
    FOURDVT_TRY(assemble(job, work.value(), *environment.device, report));
  }
  report.figures.seconds_by_stage = clock.seconds();
  report.figures.labels_by_sequence = survey.value().statistics();
  report.figures.frames = job.total_frames;
  report.figures.peak_rss_bytes = peakResidentBytes();
  report.wall_s = secondsSince(started);
  FOURDVT_TRY(writeReportFiles(job, report));
  FOURDVT_TRY(replaceFolder(job.resultFolder(), job.options.character_folder, job.workFolder() + "/previous"));
  removeFolder(job.workFolder());
  return report.figures;
}

}  // namespace

Result<BakeReport> bake(const BakeOptions& given, const BakeEnvironment& environment) {
  const auto started = Now::now();
  BakeOptions options = given;
  while (options.character_folder.size() > 1 && options.character_folder.back() == '/')
    options.character_folder.pop_back();
  StageClock clock;
  auto job = [&] {
    StageClock::Span span(clock, "validate");
    return validate(options, environment);
  }();
  if (!job) {
    removeIfEmpty(options.character_folder + ".work");
    return job.error();
  }
  auto result = runJob(job.value(), environment, clock, started);
  if (result) return result;
  Error error = result.error();
  removeFolder(job.value().resultFolder());
  if (error.id == ErrorId::WriteFailed)
    error.message += "; finished GOPs are kept in " + job.value().workFolder() + " for --resume";
  else if (error.id != ErrorId::Interrupted)
    removeFolder(job.value().workFolder());
  return error;
}

}  // namespace fourdvt::bake
