// SPDX-License-Identifier: Apache-2.0
// The recipe: validate → every missing GOP, frame by frame → assemble. Three lanes overlap: reading the next frame, the
// GPU's stages of this one (on the calling thread, which owns the context), filling and encoding the one before.
#include "bake/bake.h"

#include <cmath>
#include <cstdio>
#include <future>

#include "bake/assemble.h"
#include "bake/fill.h"
#include "bake/geometry.h"
#include "bake/order.h"
#include "bake/output.h"
#include "bake/poster.h"
#include "bake/resample.h"
#include "bake/validate.h"
#include "bake/visibility.h"

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

// The smaller layers minify the pictures if their texels are wider than this many pixels.
constexpr double kMipmapTexelPixels = 2;

bool needsMipmaps(const Job& job, const Positions& positions) {
  double world_area = 0, uv_area = 0;
  const MeshTopology& t = job.mesh.decoded.topology;
  for (uint32_t f = 0; f < t.faceCount(); ++f) {
    const glm::uvec3 v = t.face_vertices[f], w = t.face_uvs[f];
    const glm::dvec3 a(positions[v.x]);
    world_area += 0.5 * glm::length(glm::cross(glm::dvec3(positions[v.y]) - a, glm::dvec3(positions[v.z]) - a));
    const glm::dvec2 p(t.uvs[w.y] - t.uvs[w.x]), q(t.uvs[w.z] - t.uvs[w.x]);
    uv_area += 0.5 * std::abs(p.x * q.y - p.y * q.x);
  }
  const double texel_m = std::sqrt(world_area / std::max(uv_area, 1e-9)) / job.layout.layers.back().width;
  const PinholeCamera& camera = job.cameras[0];
  const double pixel_m = camera.project(glm::dvec3(positions[0])).z / camera.fx;
  return texel_m > kMipmapTexelPixels * std::abs(pixel_m);
}

struct OpenGop {
  std::unique_ptr<GopEncoder> encoder;  // made with the first frame
  ChunkBuilder chunk;
};

class Baker {
 public:
  Baker(const Job& job, const BakeEnvironment& environment, StageClock& clock)
      : job_(job), environment_(environment), clock_(clock) {}

  Status start();
  Status bakeMissing(const WorkFolder& work);
  uint32_t framesBaked() const { return baked_; }

 private:
  Status bakeGop(const WorkFolder& work, const SequencePlan& plan, uint32_t gop, capture::FrameReader& reader);
  Result<PreparedFrame> prepare(capture::FrameReader& reader);
  Result<DrawnFrame> drawFrame(PreparedFrame frame);
  Status finishFrame(const WorkFolder& work, OpenGop& open, DrawnFrame frame, uint32_t index, bool is_still);
  Status saveStill(const WorkFolder& work, const DrawnFrame& frame);
  Status waitForSave();
  bool stopped() const { return environment_.stop && *environment_.stop; }
  Status checkStop(const WorkFolder& work) const;  // Interrupted
  Status checkVisible(const DrawnFrame& frame, const SequencePlan& plan) const;
  Status saveGop(const WorkFolder& work, OpenGop& open, const SequencePlan& plan, uint32_t gop);
  void reportProgress(const SequencePlan& plan, uint32_t frame);
  std::launch lane() const { return job_.options.jobs > 1 ? std::launch::async : std::launch::deferred; }

  const Job& job_;
  const BakeEnvironment& environment_;
  StageClock& clock_;
  GpuCapture capture_;
  Visibility visibility_;
  Resampler resampler_;
  GutterMap large_map_, small_map_;
  std::vector<const GutterMap*> maps_;  // a layer each
  I420Picture picture_;
  std::future<Status> saving_;     // of the GOP before; ends before the next encoder is made: only one is in memory
  uint32_t done_ = 0, baked_ = 0;  // frames; done counts those of earlier runs
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

Status Baker::start() {
  const MeshTopology& topology = job_.mesh.decoded.topology;
  const Positions pose = job_.mesh.decoded.positions;
  auto capture = GpuCapture::create(*environment_.device, job_.cameras, topology, needsMipmaps(job_, pose));
  if (!capture) return capture.error();
  capture_ = capture.take();
  auto visibility = Visibility::create(*environment_.device, capture_);
  if (!visibility) return visibility.error();
  visibility_ = visibility.take();
  std::vector<int> sizes;
  for (const package::Rect& rect : job_.layout.layers) sizes.push_back(rect.width);
  auto resampler = Resampler::create(*environment_.device, capture_, sizes);
  if (!resampler) return resampler.error();
  resampler_ = resampler.take();
  StageClock::Span span(clock_, "fill");
  const float gutter = static_cast<float>(job_.options.gutter_texels);
  large_map_ = makeGutterMap(topology, sizes[0], gutter);
  if (sizes.size() > 1) small_map_ = makeGutterMap(topology, sizes[1], gutter * sizes[1] / sizes[0]);
  for (size_t l = 0; l < sizes.size(); ++l) maps_.push_back(l == 0 ? &large_map_ : &small_map_);
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
    auto drawn = drawFrame(prepared.take());
    if (!drawn) return drawn.error();
    if (f == 0) FOURDVT_TRY(checkVisible(drawn.value(), plan));
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

Result<DrawnFrame> Baker::drawFrame(PreparedFrame frame) {
  gpu::Device& device = *environment_.device;
  DrawnFrame out;
  std::vector<float> shares;
  {
    StageClock::Span span(clock_, "visibility");
    capture_.setFrame(device, frame.positions, frame.crops);
    auto measured = visibility_.measure(device, capture_);
    if (!measured) return measured.error();
    shares = measured.take();
  }
  {
    StageClock::Span span(clock_, "order");
    LabelOptions options;
    options.layers = job_.options.layers;
    out.labels = labelFaces(options, job_.cameras, job_.mesh.decoded.topology, frame.positions, shares);
  }
  StageClock::Span span(clock_, "resample");
  auto layers = resampler_.resample(device, capture_, out.labels);
  if (!layers) return layers.error();
  out.layers = layers.take();
  out.positions = std::move(frame.positions);
  return out;
}

Status Baker::checkVisible(const DrawnFrame& frame, const SequencePlan& plan) const {
  for (uint8_t label : frame.labels)
    if (label != package::kNoCamera) return {};
  glm::vec3 low = frame.positions[0], high = low;
  for (const glm::vec3& p : frame.positions) low = glm::min(low, p), high = glm::max(high, p);
  const glm::dvec3 centre(0.5f * (low + high));
  double distance = 0;
  for (const PinholeCamera& camera : job_.cameras) distance += glm::length(camera.centreInWorld() - centre);
  char text[400];
  std::snprintf(
      text, sizeof text,
      ": no camera sees any face of frame 0. The mesh spans (%.3g, %.3g, %.3g) to (%.3g, %.3g, %.3g) m and the "
      "cameras are %.3g m away on average: check the axes and units of meshes and cameras, and the mattes",
      low.x, low.y, low.z, high.x, high.y, high.z, distance / job_.cameras.size());
  return Error{ErrorId::NothingVisible, plan.source->folder + text};
}

Status Baker::finishFrame(const WorkFolder& work, OpenGop& open, DrawnFrame frame, uint32_t index, bool is_still) {
  {
    StageClock::Span span(clock_, "fill");
    fillLayers(maps_, frame.layers);
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
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  Progress p;
  p.stage = plan.source->name + " " + std::to_string(frame) + "/" + std::to_string(plan.source->frame_count);
  p.done = done_;
  p.total = job_.total_frames;
  p.frames_per_s = elapsed > 0 ? baked_ / elapsed : 0;
  p.left_s = p.frames_per_s > 0 ? (p.total - p.done) / p.frames_per_s : 0;
  environment_.progress(p);
}

Result<BakeReport> runJob(const Job& job, const BakeEnvironment& environment, StageClock& clock,
                          std::chrono::steady_clock::time_point started) {
  auto work = WorkFolder::open(job.workFolder(), settingsKey(job), job.options.resume);
  if (!work) return work.error();
  ReportInput report;
  {
    Baker baker(job, environment, clock);
    FOURDVT_TRY(baker.start());
    FOURDVT_TRY(baker.bakeMissing(work.value()));
    report.resumed = baker.framesBaked() < job.total_frames;
  }
  {
    StageClock::Span span(clock, "assemble");
    FOURDVT_TRY(assemble(job, work.value(), *environment.device, report));
  }
  report.figures.seconds_by_stage = clock.seconds();
  report.figures.frames = job.total_frames;
  report.figures.peak_rss_bytes = peakResidentBytes();
  report.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  FOURDVT_TRY(writeReportFiles(job, report));
  FOURDVT_TRY(replaceFolder(job.resultFolder(), job.options.character_folder, job.workFolder() + "/previous"));
  removeFolder(job.workFolder());
  return report.figures;
}

}  // namespace

Result<BakeReport> bake(const BakeOptions& given, const BakeEnvironment& environment) {
  const auto started = std::chrono::steady_clock::now();
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
