// SPDX-License-Identifier: Apache-2.0
#include "live/server/pipeline.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <thread>

#include "base/text.h"
#include "base/watch.h"
#include "encode/surfaces.h"
#include "live/server/instants.h"
#include "live/server/live_encoder.h"
#include "live/server/live_hull.h"
#include "live/server/recorder.h"
#include "live/server/tile_painter.h"
#include "live/server/tiles.h"
#include "package/live_stream.h"

namespace fourdvt::live {
namespace {

constexpr int kJpegQuality = 85;
constexpr double kFirstTolerance_px = 1, kWorthTelling = 0.1;  // minimum relative change that is sent to cameras
constexpr int kMinFramesToKey = 3;                             // minimum distance of keys requested by viewers
constexpr int64_t kWarnAgain_us = 5'000'000;

int64_t now_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

std::string randomSession() {
  std::random_device random;
  return printed("%08x%08x", random(), random());
}

std::vector<PinholeCamera> pinholesOf(const Rig& rig) {
  std::vector<PinholeCamera> out;
  for (const RigCamera& camera : rig.cameras) out.push_back(camera.camera.pinhole);
  return out;
}

Status checkOptions(const Rig& rig, const PipelineOptions& o) {
  const auto invalid = [](const std::string& text) { return Error{ErrorId::InvalidArgument, text}; };
  if (rig.cameras.size() < kMinPictures || rig.cameras.size() > size_t(package::kMaxCameras))
    return invalid(rig.path + ": a live stage has 2 to " + std::to_string(package::kMaxCameras) + " cameras, not " +
                   std::to_string(rig.cameras.size()) + "; add or remove some");
  if (!(rig.fps >= 1 && rig.fps <= 120)) return invalid(rig.path + ": \"fps\" must be 1 to 120; correct it");
  if (!(o.wait_s >= 0 && o.wait_s <= 5) || !(o.lost_s > 0))
    return invalid("the time to wait for cameras must be 0 to 5 s, and that to give them up above 0; correct it");
  if (!(o.picture_share > 0 && o.picture_share <= 1))
    return invalid("the share of the picture must be above 0 and at most 1; correct it");
  if (o.crf < 0 || o.crf > 51) return invalid("crf must be 0 to 51; correct it");
  if (o.max_gop < 1) return invalid("a key is needed every 1 or more frames; correct it");
  if (!(o.min_tolerance_px > 0 && o.min_tolerance_px <= o.max_tolerance_px && o.max_tolerance_px <= 64))
    return invalid("tolerances must be above 0 and at most 64 pixels, the least first; correct them");
  if (!(o.busy_share > 0)) return invalid("the share of a frame's time must be above 0; correct it");
  return {};
}

// Triangle below the size of a pixel, for frames without a performer, since every frame requires a surface.
TriangleMesh nothing(const Rig& rig) {
  const glm::vec3 at(0.5f * (rig.bounds.min.x + rig.bounds.max.x), rig.bounds.min.y,
                     0.5f * (rig.bounds.min.z + rig.bounds.max.z));
  return {{at, at + glm::vec3(0, 0, kPositionStep_m), at + glm::vec3(kPositionStep_m, 0, 0)}, {{0, 1, 2}}};
}

// Frame in progress: the surface thread makes its surface, the picture thread then draws its picture.
struct FrameInWork {
  Instant instant;
  uint32_t number = 0;  // numbered by the picture thread without gaps: a missing number is a lost frame
  enum class Surface { Awaited, Made, Failed } surface = Surface::Awaited;  // members below are valid once it is Made
  bool key = false, clears = false;
  std::vector<package::CameraTile> tiles;
  std::vector<uint8_t> chunk;
  size_t triangles = 0;
  double hull_ms = 0;
};

// Tiles without those of cameras that lack a picture, which the player must not sample.
std::vector<package::CameraTile> shownTiles(std::vector<package::CameraTile> tiles,
                                            std::span<const package::Rect> crops) {
  for (size_t c = 0; c < tiles.size(); ++c)
    if (crops[c].width == 0) tiles[c] = {};
  return tiles;
}

class LivePipeline final : public Pipeline {
 public:
  LivePipeline(const Rig& rig, const PipelineOptions& options, PipelineEvents events, const PackedSize& size,
               HullMaker hulls, std::unique_ptr<LiveEncoder> encoder)
      : rig_(rig),
        options_(options),
        events_(std::move(events)),
        pinholes_(pinholesOf(rig)),
        size_(size),
        hulls_(std::move(hulls)),
        encoder_(std::move(encoder)),
        manifest_(liveManifest(rig, {randomSession(), encoder_->codec(), size})),
        painter_(size),
        cameras_(rig.cameras.size()),
        instants_({rig.cameras.size(), rig.fps, options.wait_s, options.lost_s}),
        control_({options.min_tolerance_px, options.max_tolerance_px, options.busy_share}, kFirstTolerance_px),
        tolerance_px_(control_.tolerance_px()),
        wanted_crf_(options.crf),
        tiles_(pinholes_, size),
        regions_(pinholes_) {
    for (Camera& camera : cameras_) camera.settings = {tolerance_px_, kJpegQuality, {}};
  }

  ~LivePipeline() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    handed_.notify_all();
    for (std::thread* thread : {&surface_thread_, &picture_thread_})
      if (thread->joinable()) thread->join();
    recorder_.reset();
  }

  Status begin() {
    for (size_t c = 0; c < cameras_.size(); ++c) {
      FOURDVT_ASSIGN(decoders_.emplace_back(), JpegDecoder::create());
    }
    if (!options_.record_folder.empty()) {
      FOURDVT_ASSIGN(recorder_,
                     Recorder::start(rig_, options_.record_folder, [this](const std::string& line) { warn(line); }));
    }
    surface_thread_ = std::thread([this] { makeSurfaces(); });
    picture_thread_ = std::thread([this] { makePictures(); });
    return {};
  }

  const std::string& manifest() const override { return manifest_; }

  CameraSettings settings(size_t camera) const override {
    const std::lock_guard lock(mutex_);
    return cameras_[camera].settings;
  }

  void setConnected(size_t camera, bool connected) override {
    {
      const std::lock_guard lock(mutex_);
      instants_.setConnected(camera, connected, now_us());
      cameras_[camera].clock.reset();
    }
    wake_.notify_all();  // departed cameras are no longer waited for
  }

  void onClock(size_t camera, const ClockAnswer& answer, int64_t now_us) override {
    const std::lock_guard lock(mutex_);
    cameras_[camera].clock.add(answer, now_us);
  }

  void onPicture(size_t camera, CameraPicture picture, size_t message_bytes, int64_t now_us) override {
    const PinholeCamera& p = pinholes_[camera];
    const package::Rect& crop = picture.crop;
    if (crop.x < 0 || crop.y < 0 || crop.x + crop.width > p.width || crop.y + crop.height > p.height)
      picture.crop = {}, picture.jpeg.clear();
    auto timed = std::make_shared<TimedPicture>();
    timed->picture = std::move(picture);
    {
      const std::lock_guard lock(mutex_);
      Camera& c = cameras_[camera];
      ++c.pictures;
      const double jpeg_bytes = double(timed->picture.jpeg.size());
      c.keyed_ms.add(now_us, timed->picture.keyed_us / 1e3);
      c.picture_bytes.add(now_us, jpeg_bytes);
      c.contour_bytes.add(now_us, double(message_bytes) - jpeg_bytes);
      const int64_t captured_us = timed->picture.captured_us;
      const bool dated =
          c.clock.known() && captured_us > -ClockOffset::kLatest_us && captured_us < ClockOffset::kLatest_us;
      if (dated) timed->captured_us = c.clock.toServer(captured_us);
      c.last = timed;
      if (dated) instants_.add(camera, std::move(timed), now_us);
    }
    wake_.notify_all();
  }

  void wantKey() override {
    const std::lock_guard lock(mutex_);
    want_key_ = true;
  }

  void setTolerance(double tolerance_px) override {
    const std::lock_guard lock(mutex_);
    fixed_tolerance_px_ = tolerance_px > 0 ? std::clamp(tolerance_px, 0.0, 64.0) : 0;
  }

  void setCrf(int crf) override {
    const std::lock_guard lock(mutex_);
    wanted_crf_ = std::clamp(crf, 0, 51);
    want_key_ = true;
  }

  PipelineStatus status() const override {
    const std::lock_guard lock(mutex_);
    const int64_t now = now_us();
    PipelineStatus out = status_;
    out.skipped = instants_.skipped();
    out.failed += instants_.tooFew();
    out.frames_per_s = frames_.sum(now);
    out.hull_ms = hull_ms_.median(now), out.picture_ms = picture_ms_.median(now);
    out.encode_ms = encode_ms_.median(now), out.latency_ms = latency_ms_.median(now);
    out.triangles = triangles_.median(now), out.tolerance_px = tolerance_px_;
    out.surface_bytes_per_s = surface_bytes_.sum(now), out.picture_bytes_per_s = picture_bytes_.sum(now);
    out.recorded = recorder_ ? recorder_->recorded() : 0;
    for (size_t i = 0; i < cameras_.size(); ++i) {
      const Camera& c = cameras_[i];
      out.cameras.push_back({pinholes_[i].name, instants_.connected(i), instants_.lost(i, now), c.pictures,
                             instants_.late(i), c.keyed_ms.median(now), c.contour_bytes.sum(now),
                             c.picture_bytes.sum(now), double(c.clock.offset_us()) / 1e3});
    }
    return out;
  }

  CameraPicture lastPicture(size_t camera) const override {
    std::shared_ptr<const TimedPicture> last;
    {
      const std::lock_guard lock(mutex_);
      last = cameras_[camera].last;
    }
    return last ? last->picture : CameraPicture();
  }

 private:
  struct Camera {
    ClockOffset clock;
    CameraSettings settings;  // settings sent last
    std::shared_ptr<const TimedPicture> last;
    uint64_t pictures = 0;
    Recent keyed_ms, contour_bytes, picture_bytes;
  };
  using Frame = std::shared_ptr<FrameInWork>;

  // --- surface thread ---
  void makeSurfaces() {
    while (Frame frame = nextFrame()) {
      Watch watch;
      const Status made = makeSurface(*frame);
      if (!made.ok()) warn(made.error().message);
      frame->hull_ms = watch.lap_ms();
      {
        const std::lock_guard lock(mutex_);
        frame->surface = made.ok() ? FrameInWork::Surface::Made : FrameInWork::Surface::Failed;
        if (!made.ok()) ++status_.failed;
      }
      handed_.notify_all();
      tellSettings();
    }
  }

  // Waits for an instant, and until the picture thread has taken the previous frame; null: the end.
  Frame nextFrame() {
    std::optional<Instants::Taken> taken;
    Frame frame;
    std::unique_lock lock(mutex_);
    while (!stop_) {
      if (!pending_) taken = instants_.take(now_us());
      if (taken) break;
      const auto due = pending_ ? std::nullopt : instants_.due_us();
      if (due)
        wake_.wait_for(lock, std::chrono::microseconds(std::max<int64_t>(*due - now_us(), 0) + 500));
      else
        wake_.wait(lock);
    }
    if (stop_) return nullptr;
    frame = std::make_shared<FrameInWork>();
    frame->instant = std::move(taken->instant);
    pending_ = frame;
    lock.unlock();
    handed_.notify_all();
    if (recorder_) {
      for (const Instant& skipped : taken->skipped) recorder_->add(skipped);
      recorder_->add(frame->instant);
    }
    return frame;
  }

  Status makeSurface(FrameInWork& frame) {
    std::vector<const std::vector<Ring16>*> rings;
    std::vector<package::Rect> crops;
    for (const auto& p : frame.instant.pictures) {
      rings.push_back(p ? &p->picture.rings : nullptr);
      crops.push_back(p ? p->picture.crop : package::Rect{});
    }
    auto hull = hulls_.make(rings);
    boxes_.clear();
    if (!hull.ok()) return hull.error();
    TriangleMesh& mesh = hull.value().mesh;
    const bool empty = mesh.faces.empty();
    if (!empty)
      for (const PinholeCamera& camera : pinholes_) boxes_.push_back(projectedBox(camera, mesh.positions));
    chooseTiles(frame, empty, crops);
    frame.triangles = mesh.faces.size();
    auto chunk = encode(frame, mesh, crops);
    if (!chunk.ok() || empty) {
      FOURDVT_ASSIGN(frame.chunk, encode(frame, nothing(rig_), crops));
      const std::lock_guard lock(mutex_);
      ++status_.failed;
    } else {
      frame.chunk = chunk.take();
    }
    for (const size_t camera : hull.value().left_out)
      warn("camera " + pinholes_[camera].name + " is left out of the hull: its outline does not fit");
    return {};
  }

  Result<std::vector<uint8_t>> encode(const FrameInWork& frame, const TriangleMesh& mesh,
                                      std::span<const package::Rect> crops) const {
    const encode::PositionGrid grid{glm::dvec3(rig_.bounds.min), double(kPositionStep_m)};
    const std::vector<package::QuantisedSurface> surface{
        encode::quantisedSurface(grid, mesh.positions, mesh.faces, true)};
    FOURDVT_ASSIGN(auto encoded, package::encodeSurfaceChunk(shownTiles(frame.tiles, crops), surface));
    if (encoded.vertex_count > kMaxVertices || encoded.face_count > kMaxFaces)
      return Error{ErrorId::Internal, "a surface of too many triangles"};
    return std::move(encoded.bytes);
  }

  // Chooses keys and layouts: a key is due, requested, or required because the performer leaves a tile's source.
  void chooseTiles(FrameInWork& frame, bool empty, std::span<const package::Rect> crops) {
    bool key = since_key_ + 1 >= options_.max_gop || tiles_.tiles().empty();
    if (!empty && tiles_.wantsLayout(boxes_, crops)) key = true;
    {
      const std::lock_guard lock(mutex_);
      key = key || picture_failed_ || (want_key_ && since_key_ + 1 >= kMinFramesToKey);
      if (key) want_key_ = picture_failed_ = false;
    }
    if (key && (!empty || tiles_.tiles().empty())) {
      std::vector<package::Rect> none(pinholes_.size());
      tiles_.plan(empty ? none : boxes_, crops);
      frame.clears = true;
    }
    since_key_ = key ? 0 : since_key_ + 1;
    frame.key = key;
    frame.tiles = tiles_.tiles();
  }

  // Sends the cameras their settings if these have changed.
  void tellSettings() {
    std::vector<std::pair<size_t, CameraSettings>> changed;
    const int64_t now = now_us();
    const std::vector<bool> moved = regions_.update(boxes_, now);
    {
      const std::lock_guard lock(mutex_);
      if (fixed_tolerance_px_ > 0)
        tolerance_px_ = fixed_tolerance_px_;
      else
        tolerance_px_ = control_.tolerance_px();
      for (size_t c = 0; c < cameras_.size(); ++c) {
        CameraSettings& told = cameras_[c].settings;
        const bool other = std::abs(tolerance_px_ - told.tolerance_px) > kWorthTelling * told.tolerance_px;
        if (!moved[c] && !other) continue;
        told = {tolerance_px_, kJpegQuality, regions_.region(c)};
        changed.emplace_back(c, told);
      }
    }
    const std::lock_guard lock(events_mutex_);
    for (const auto& [camera, settings] : changed)
      if (events_.on_settings) events_.on_settings(camera, settings);
  }

  // --- picture thread ---
  void makePictures() {
    for (;;) {
      Frame frame;
      {
        std::unique_lock lock(mutex_);
        handed_.wait(lock, [&] { return stop_ || pending_; });
        if (stop_) return;
        frame = std::move(pending_);
        pending_ = nullptr;
      }
      wake_.notify_all();
      Watch watch;
      std::vector<std::optional<JpegPlanes>> planes = decode(*frame);
      double picture_ms = watch.lap_ms();
      {
        std::unique_lock lock(mutex_);
        handed_.wait(lock, [&] { return stop_ || frame->surface != FrameInWork::Surface::Awaited; });
        if (stop_) return;
      }
      if (frame->surface == FrameInWork::Surface::Failed) continue;
      watch.lap_ms();
      frame->number = ++number_;
      draw(*frame, planes);
      picture_ms += watch.lap_ms();
      finish(*frame, picture_ms);
    }
  }

  std::vector<std::optional<JpegPlanes>> decode(const FrameInWork& frame) {
    std::vector<std::optional<JpegPlanes>> out(cameras_.size());
    for (size_t c = 0; c < cameras_.size(); ++c) {
      const auto& p = frame.instant.pictures[c];
      if (!p || p->picture.crop.width == 0) continue;
      const package::Rect& crop = p->picture.crop;
      auto planes = decoders_[c]->decode(p->picture.jpeg, crop.width, crop.height);
      if (planes.ok())
        out[c] = planes.value();
      else
        warn("camera " + pinholes_[c].name + ": " + planes.error().message);
    }
    return out;
  }

  void draw(const FrameInWork& frame, std::span<const std::optional<JpegPlanes>> planes) {
    if (frame.clears) painter_.clear();
    for (size_t c = 0; c < planes.size(); ++c)
      if (planes[c])
        painter_.draw(frame.tiles[c], *planes[c], frame.instant.pictures[c]->picture.crop,
                      frame.instant.pictures[c]->picture.rings);
    painter_.drawBarcode(frame.number);
  }

  void finish(const FrameInWork& frame, double picture_ms) {
    Watch watch;
    if (frame.key) {
      const std::lock_guard lock(mutex_);
      encoder_->setCrf(wanted_crf_);
    }
    const auto encoded = encoder_->encode(painter_.view(), frame.key);
    if (!encoded.ok()) {
      warn(encoded.error().message);
      const std::lock_guard lock(mutex_);
      picture_failed_ = true;
      return;
    }
    const double encode_ms = watch.lap_ms();
    const EncodedPicture& picture = encoded.value();
    auto bytes = std::make_shared<const std::vector<uint8_t>>(
        package::writeLiveFrame({frame.number, picture.key, frame.instant.captured_us, frame.chunk, picture.sample}));
    count(frame, picture, picture_ms, encode_ms);
    const std::lock_guard lock(events_mutex_);
    if (events_.on_frame) events_.on_frame(std::move(bytes), picture.key);
  }

  void count(const FrameInWork& frame, const EncodedPicture& picture, double picture_ms, double encode_ms) {
    const int64_t now = now_us();
    const std::lock_guard lock(mutex_);
    ++status_.frames;
    if (!frame.instant.complete) ++status_.incomplete;
    frames_.add(now, 1);
    hull_ms_.add(now, frame.hull_ms);
    picture_ms_.add(now, picture_ms);
    encode_ms_.add(now, encode_ms);
    latency_ms_.add(now, double(now - frame.instant.captured_us) / 1e3);
    triangles_.add(now, double(frame.triangles));
    surface_bytes_.add(now, double(frame.chunk.size()));
    picture_bytes_.add(now, double(picture.sample.size()));
    if (frame.triangles > 0 && fixed_tolerance_px_ == 0)
      control_.add(now, frame.hull_ms * rig_.fps / 1e3, (picture_ms + encode_ms) * rig_.fps / 1e3);
  }

  // --- both threads ---
  void warn(const std::string& line) {
    const int64_t now = now_us();
    const std::lock_guard lock(events_mutex_);
    auto [at, first] = warned_us_.try_emplace(line, now);
    if (!first && now - at->second < kWarnAgain_us) return;
    at->second = now;
    if (events_.on_warning) events_.on_warning(line);
  }

  const Rig rig_;
  const PipelineOptions options_;
  const PipelineEvents events_;
  const std::vector<PinholeCamera> pinholes_;
  const PackedSize size_;
  const HullMaker hulls_;
  const std::unique_ptr<LiveEncoder> encoder_;  // used by the picture thread
  const std::string manifest_;
  std::vector<std::unique_ptr<JpegDecoder>> decoders_;
  TilePainter painter_;
  uint32_t number_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable wake_, handed_;  // wake_ for the surface thread; handed_ for the picture thread
  bool stop_ = false;
  std::vector<Camera> cameras_;
  Instants instants_;
  ToleranceControl control_;
  double tolerance_px_, fixed_tolerance_px_ = 0;
  int wanted_crf_;
  bool want_key_ = false, picture_failed_ = false;
  Frame pending_;          // next frame of the picture thread
  PipelineStatus status_;  // counts only
  Recent frames_, hull_ms_, picture_ms_, encode_ms_, latency_ms_, triangles_, surface_bytes_, picture_bytes_;

  LiveTiles tiles_;  // used by the surface thread, as are all members below
  CameraRegions regions_;
  std::vector<package::Rect> boxes_;  // last hull's bounding box in each camera; empty: no hull
  int since_key_ = 0;

  std::mutex events_mutex_;  // serialises events
  std::map<std::string, int64_t> warned_us_;
  std::unique_ptr<Recorder> recorder_;
  std::thread surface_thread_, picture_thread_;
};

}  // namespace

Result<std::unique_ptr<Pipeline>> Pipeline::start(const Rig& rig, const PipelineOptions& options,
                                                  PipelineEvents events) {
  FOURDVT_TRY(checkOptions(rig, options));
  const std::vector<PinholeCamera> cameras = pinholesOf(rig);
  FOURDVT_ASSIGN(const PackedSize size, packedSize(cameras, options.picture_share));
  FOURDVT_ASSIGN(auto hulls, HullMaker::create(cameras, {rig.bounds}));
  FOURDVT_ASSIGN(auto encoder, LiveEncoder::create({size.width, size.height, rig.fps, options.crf}));
  auto pipeline =
      std::make_unique<LivePipeline>(rig, options, std::move(events), size, std::move(hulls), std::move(encoder));
  FOURDVT_TRY(pipeline->begin());
  return std::unique_ptr<Pipeline>(std::move(pipeline));
}

}  // namespace fourdvt::live
