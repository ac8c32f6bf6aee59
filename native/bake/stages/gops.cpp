// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <future>

#include "bake/run/renditions.h"
#include "bake/run/stream_reader.h"
#include "bake/stages/stages.h"
#include "bake/stages/survey.h"
#include "bake/texels/detail.h"
#include "encode/surfaces.h"
#include "package/barcode.h"
#include "package/chunk_mesh.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

// State of a GOP in progress, for either appearance.
struct OpenGop {
  uint32_t number = 0;
  std::unique_ptr<LadderEncoder> encoder;  // created with the first frame
  GopArtefact artefact;
};

// JPEG of a whole tiled picture.
Result<std::vector<uint8_t>> tiledJpeg(const encode::I420Picture& picture) {
  return platform::encodeImage(encode::rgbFromTile(picture.view(), {0, 0, picture.width, picture.height}), ".jpg", 80);
}

// Finished GOPs, the progress over their frames, and their encoding, for either appearance.
class GopWork {
 public:
  explicit GopWork(BakeRun& run) : run_(run), job_(run.job) {}

 protected:
  bool isFirst(const StreamPlan& plan) const { return &plan == job_.streams.data(); }
  bool isFinished(const StreamPlan& plan, uint32_t gop) const {
    if (!run_.work.has(gopFile(plan.name, gop))) return false;
    if (!plan.isClass() && !run_.work.has(chunkFile(plan.name, gop))) return false;
    return job_.fromCameras() || !isFirst(plan) || gop > 0 || run_.work.has(kStillFile);
  }
  double frameWork(const StreamPlan& plan) const {
    return encodeWork(job_.options) * double(plan.motion.members.size());
  }
  void skip(const StreamPlan& plan, uint32_t gop) {
    const uint32_t frames = plan.gopEnd(gop) - plan.gop_first_frames[gop];
    run_.progress.frames_done += frames;
    run_.progress.skip(frames * frameWork(plan));
  }
  void tellFrame(const StreamPlan& plan, uint32_t frame) {
    ++run_.progress.frames_done;
    ++baked_;
    run_.progress.worked(frameWork(plan));
    const double elapsed = run_.progress.seconds() - started_s_;
    run_.progress.tell(plan.name + " " + std::to_string(frame) + "/" + std::to_string(plan.frameCount()),
                       elapsed > 0 ? baked_ / elapsed : 0);
  }
  Status encode(OpenGop& open, const StreamPlan& plan, const encode::I420Picture& picture,
                const std::vector<const Image*>& parts, uint32_t frame) {
    StageClock::Span span(run_.clock, Stage::Encode);
    if (!open.encoder) {
      FOURDVT_ASSIGN(open.encoder, LadderEncoder::create(plan, open.number, run_.lane()));
      if (plan.isClass() || (job_.fromCameras() && frame == 0)) {
        FOURDVT_ASSIGN(open.artefact.picture_jpeg, tiledJpeg(picture));
      }
    }
    return open.encoder->push(picture.view(), parts, frame);
  }
  Status finishVideos(OpenGop& open) {
    StageClock::Span span(run_.clock, Stage::Encode);
    FOURDVT_ASSIGN(open.artefact.videos, open.encoder->finish());
    open.encoder.reset();
    return {};
  }

  BakeRun& run_;
  const Job& job_;
  uint32_t baked_ = 0;  // frames baked by this run
  double started_s_ = 0;
};

// Downsamples layer 1 to kAtlasSide by means of equal blocks; the layer's side is a multiple of it.
Image atlasOf(const Image& layer) {
  Image out(kAtlasSide, kAtlasSide, 3);
  const int block = layer.width / kAtlasSide;
  for (int y = 0; y < kAtlasSide; ++y)
    for (int x = 0; x < kAtlasSide; ++x) {
      int sum[3] = {0, 0, 0};
      for (int row = y * block; row < (y + 1) * block; ++row)
        for (int column = x * block; column < (x + 1) * block; ++column)
          for (int c = 0; c < 3; ++c) sum[c] += layer.at(column, row)[c];
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = static_cast<uint8_t>(sum[c] / (block * block));
    }
  return out;
}

Image withoutAlpha(const Image& rgba) {
  Image out(rgba.width, rgba.height, 3);
  for (size_t i = 0; i < out.pixels.size() / 3; ++i) std::copy_n(&rgba.pixels[4 * i], 3, &out.pixels[3 * i]);
  return out;
}

// [frame] of a captured sequence's stream: true if a class shows it.
std::vector<bool> shownByClasses(const Job& job, const StreamPlan& plan) {
  std::vector<bool> shown(plan.frameCount(), false);
  if (plan.isClass()) return shown;
  for (const StreamPlan& other : job.streams)
    for (size_t m = 0; other.isClass() && m < other.motion.members.size(); ++m)
      for (uint32_t f = 0; other.motion.members[m].source->name == plan.name && f < other.frameCount(); ++f)
        shown[other.sourceFrame(m, f)] = true;
  return shown;
}

// One member's share of a picture.
struct MemberLook {
  std::vector<uint8_t> labels;
  std::vector<Image> layers;  // filled: RGB, before that RGBA
  bool filled = false;
  Image atlas;
};

struct LayerGop : OpenGop {
  explicit LayerGop(ChunkBuilder builder) : chunk(std::move(builder)) {}
  ChunkBuilder chunk;
  // [frame][member], without the detail of the GOP; neighbouring frames may share a look.
  std::vector<std::vector<std::shared_ptr<const MemberLook>>> looks;
};

// GOPs of a character from layers. Lanes overlap: reading the next frame, the GPU stages of this one (on the calling
// thread, which owns the context), filling the previous one; and encoding the previous GOP, which needs the detail of
// all its frames. A class reuses frames that its members' own streams have rendered and filled: they are stored in the
// work folder until then, and rendered again if an interrupted bake left none. Memory: the layers of two GOPs.
class LayerGops : GopWork {
 public:
  LayerGops(BakeRun& run, const Survey& survey) : GopWork(run), survey_(survey) {}

  Result<uint32_t> run();
  Status runOne(const StreamPlan& plan, uint32_t gop);

 private:
  struct DrawnFrame {
    std::vector<std::optional<MemberLook>> members;  // none: unchanged
    FrameGeometry geometry;
  };

  Status start();
  Status bakeStream(const StreamPlan& plan);
  Result<std::unique_ptr<StreamReader>> openStream(const StreamPlan& plan);
  Status bakeGop(const StreamPlan& plan, uint32_t gop, StreamReader& reader);
  Result<DrawnFrame> drawFrame(const StreamPlan& plan, PreparedFrame frame);
  Result<MemberLook> drawMember(const capture::CaptureSequence& sequence, uint32_t source_frame,
                                const SourceFrame& source);
  Result<MemberLook> keptMember(const capture::CaptureSequence& sequence, PreparedMember kept) const;
  void keepForClasses(const StreamPlan& plan, uint32_t frame);
  Status fillFrame(LayerGop& open, const StreamPlan& plan, DrawnFrame frame, uint32_t index);
  Status encodeFrames(LayerGop& open, const StreamPlan& plan);
  Status saveStill(const encode::I420Picture& picture, const std::vector<uint8_t>& labels);
  Status saveGop(LayerGop& open, const StreamPlan& plan, uint32_t gop);
  Status waitForSave();

  const Survey& survey_;
  package::ChunkMesh chunk_mesh_;
  std::unique_ptr<FrameBaker> frames_;
  std::vector<std::shared_ptr<const MemberLook>> looks_;  // [member] of the stream's latest filled frame
  std::vector<bool> kept_;                                // [frame] of the stream: a class shows it later
  std::future<Status> saving_;  // previous GOP; finishes before the next one is encoded: one encoder is in memory
};

Status LayerGops::start() {
  StageClock::Span span(run_.clock, Stage::Fill);  // mostly the gutter maps
  FrameBakerOptions options;
  for (const package::Rect& rect : job_.layout.layers) options.layer_sizes.push_back(rect.width);
  options.gutter_texels = static_cast<float>(job_.options.gutter_texels);
  options.resample = job_.options.resample;
  options.length_scale = float(job_.length_scale);
  if (job_.options.colour_calibration) options.colour_maps = survey_.colourMaps();
  const package::BaseMesh& mesh = job_.mesh.decoded;
  FOURDVT_ASSIGN(frames_, FrameBaker::create(run_.device(), job_.cameras, mesh.topology, mesh.positions, options));
  chunk_mesh_ = package::makeChunkMesh(mesh);
  return {};
}

Result<uint32_t> LayerGops::run() {
  FOURDVT_TRY(start());
  started_s_ = run_.progress.seconds();
  for (const StreamPlan& plan : job_.streams) FOURDVT_TRY(bakeStream(plan));
  run_.work.removeLayers();
  FOURDVT_TRY(waitForSave());
  return baked_;
}

Status LayerGops::runOne(const StreamPlan& plan, uint32_t gop) {
  if (isFinished(plan, gop)) return {};
  FOURDVT_TRY(start());
  FOURDVT_ASSIGN(const auto reader, openStream(plan));
  FOURDVT_TRY(bakeGop(plan, gop, *reader));
  return waitForSave();
}

Result<std::unique_ptr<StreamReader>> LayerGops::openStream(const StreamPlan& plan) {
  FOURDVT_ASSIGN(auto reader, StreamReader::create(run_, plan));
  looks_.assign(plan.motion.members.size(), {});
  kept_ = shownByClasses(job_, plan);
  return reader;
}

Status LayerGops::bakeStream(const StreamPlan& plan) {
  std::unique_ptr<StreamReader> reader;  // stays open over neighbouring GOPs
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    if (isFinished(plan, g)) {
      skip(plan, g);
      reader.reset();
      continue;
    }
    if (!reader) {
      FOURDVT_ASSIGN(reader, openStream(plan));
    }
    FOURDVT_TRY(bakeGop(plan, g, *reader));
    if (run_.stopped()) FOURDVT_TRY(waitForSave());  // on every lane: a finished GOP is saved
    FOURDVT_TRY(run_.checkStop());
  }
  return {};
}

Status LayerGops::bakeGop(const StreamPlan& plan, uint32_t gop, StreamReader& reader) {
  if (run_.lane() == std::launch::deferred) FOURDVT_TRY(waitForSave());  // nothing overlaps: one GOP in memory
  auto open = std::make_unique<LayerGop>(ChunkBuilder(job_, plan));
  open->number = gop;
  const uint32_t first = plan.gop_first_frames[gop], end = plan.gopEnd(gop);
  const auto read = [&](uint32_t frame) { return reader.read(frame); };
  std::future<Result<PreparedFrame>> next = std::async(run_.lane(), read, first);  // futures join on every return
  std::future<Status> filled;
  for (uint32_t f = first; f < end; ++f) {
    FOURDVT_ASSIGN(auto prepared, next.get());
    if (f + 1 < end) next = std::async(run_.lane(), read, f + 1);
    FOURDVT_ASSIGN(auto drawn, drawFrame(plan, std::move(prepared)));
    if (f > first) FOURDVT_TRY(filled.get());
    filled = std::async(run_.lane(), [this, &open = *open, &plan, f, frame = std::move(drawn)]() mutable {
      return fillFrame(open, plan, std::move(frame), f);
    });
    tellFrame(plan, f + 1);
    if (f + 1 < end) FOURDVT_TRY(run_.checkStop());
  }
  FOURDVT_TRY(filled.get());
  FOURDVT_TRY(waitForSave());
  saving_ = std::async(run_.lane(), [this, &plan, gop, open = std::move(open)] { return saveGop(*open, plan, gop); });
  return {};
}

Status LayerGops::waitForSave() { return saving_.valid() ? saving_.get() : Status(); }

Result<LayerGops::DrawnFrame> LayerGops::drawFrame(const StreamPlan& plan, PreparedFrame frame) {
  DrawnFrame out;
  for (size_t m = 0; m < frame.members.size(); ++m) {
    PreparedMember& member = frame.members[m];
    const capture::CaptureSequence& sequence = *plan.motion.members[m].source;
    out.members.emplace_back();
    if (!member.fresh && member.kept_layers.empty()) continue;
    FOURDVT_ASSIGN(out.members.back(), member.fresh ? drawMember(sequence, member.source_frame, *member.fresh)
                                                    : keptMember(sequence, std::move(member)));
  }
  out.geometry = std::move(frame.geometry);
  return out;
}

Result<MemberLook> LayerGops::drawMember(const capture::CaptureSequence& sequence, uint32_t source_frame,
                                         const SourceFrame& source) {
  MemberLook out;
  FOURDVT_ASSIGN(out.labels, survey_.labels(sequence, source_frame));
  StageClock::Span span(run_.clock, Stage::Resample);
  frames_->setFrame(source.pose, source.crops);
  if (const TexelRule rule = job_.options.texel_rule) {
    FOURDVT_ASSIGN(auto order, survey_.penaltyOrder(sequence, source_frame));
    FOURDVT_ASSIGN(out.layers, frames_->resample(rule, order));
  } else {
    FOURDVT_ASSIGN(out.layers, frames_->resample(out.labels));
  }
  return out;
}

Result<MemberLook> LayerGops::keptMember(const capture::CaptureSequence& sequence, PreparedMember kept) const {
  MemberLook out;
  FOURDVT_ASSIGN(out.labels, survey_.labels(sequence, kept.source_frame));
  out.layers = std::move(kept.kept_layers);
  out.filled = true;
  return out;
}

// Ignores a full disk: without these files the class renders its frames itself.
void LayerGops::keepForClasses(const StreamPlan& plan, uint32_t frame) {
  if (!kept_[frame] || run_.work.save(layersFile(plan.name, frame), looks_[0]->layers, store::Written::ToCache).ok())
    return;
  kept_.assign(kept_.size(), false);
  run_.work.removeLayers();
}

Status LayerGops::fillFrame(LayerGop& open, const StreamPlan& plan, DrawnFrame frame, uint32_t index) {
  for (size_t m = 0; m < looks_.size(); ++m) {
    if (!frame.members[m]) continue;
    StageClock::Span span(run_.clock, Stage::Fill);
    auto look = std::make_shared<MemberLook>(std::move(*frame.members[m]));
    if (!look->filled) {
      frames_->fill(look->layers);
      for (Image& layer : look->layers) layer = withoutAlpha(layer);
    }
    look->atlas = atlasOf(look->layers[0]);
    looks_[m] = std::move(look);
  }
  keepForClasses(plan, index);
  std::vector<uint8_t> labels;
  for (const auto& look : looks_) {
    labels.insert(labels.end(), look->labels.begin(), look->labels.end());
    open.artefact.atlases.push_back(look->atlas);
  }
  open.chunk.add(frame.geometry, labels);
  open.looks.push_back(looks_);
  return {};
}

// Encodes the GOP's pictures, with the detail of all of its frames.
Status LayerGops::encodeFrames(LayerGop& open, const StreamPlan& plan) {
  const size_t layers = job_.options.layers, members = open.looks[0].size();
  std::vector<DetailMean> details(job_.options.common_detail ? members * layers : 0);
  std::vector<Image> shown(members * layers);  // [member][layer]
  encode::I420Picture picture(plan.layout().width, plan.layout().height);
  const auto isNew = [&](size_t frame, size_t m) {
    return frame == 0 || open.looks[frame][m] != open.looks[frame - 1][m];
  };
  const auto forEachNew = [&](size_t frame, const auto& work) {
    StageClock::Span span(run_.clock, Stage::Detail);
    for (size_t m = 0; m < members; ++m)
      for (size_t l = 0; l < layers && isNew(frame, m); ++l) work(m * layers + l, open.looks[frame][m]->layers[l]);
  };
  for (size_t f = 0; f < open.looks.size() && !details.empty(); ++f)
    forEachNew(f, [&](size_t i, const Image& layer) { details[i].add(layer); });
  for (size_t f = 0; f < open.looks.size(); ++f) {
    forEachNew(f,
               [&](size_t i, const Image& layer) { shown[i] = details.empty() ? layer : details[i].sharpened(layer); });
    std::vector<const Image*> parts;
    for (const Image& layer : shown) parts.push_back(&layer);
    const uint32_t index = plan.gop_first_frames[open.number] + static_cast<uint32_t>(f);
    {
      StageClock::Span span(run_.clock, Stage::Tile);
      encode::tileFrame(plan.layout(), parts, index, picture);
    }
    if (index == 0 && isFirst(plan)) FOURDVT_TRY(saveStill(picture, open.looks[f][0]->labels));
    FOURDVT_TRY(encode(open, plan, picture, parts, index));
  }
  open.looks.clear();
  return finishVideos(open);
}

Status LayerGops::saveStill(const encode::I420Picture& picture, const std::vector<uint8_t>& labels) {
  StageClock::Span span(run_.clock, Stage::Assemble);
  FOURDVT_ASSIGN(auto texture,
                 platform::encodeImage(encode::rgbFromTile(picture.view(), job_.layout.layers[0]), ".jpg", 90));
  FOURDVT_ASSIGN(auto tile_jpeg, tiledJpeg(picture));
  return run_.work.save(kStillFile, StillArtefact{picture, labels, std::move(texture), std::move(tile_jpeg)});
}

Status LayerGops::saveGop(LayerGop& open, const StreamPlan& plan, uint32_t gop) {
  FOURDVT_TRY(encodeFrames(open, plan));
  StageClock::Span span(run_.clock, Stage::Geometry);
  package::ChunkFrames frames = open.chunk.finish();
  if (plan.isClass()) {
    open.artefact.frames = std::move(frames);
  } else {
    FOURDVT_TRY(saveChunks(run_, plan, gop, frames, chunk_mesh_));
  }
  return run_.work.save(gopFile(plan.name, gop), open.artefact);
}

struct CameraGop : OpenGop {
  std::vector<package::QuantisedSurface> surfaces;
  std::future<Status> encoding;  // previous frame; the last field: finishes before the others are destroyed
};

// GOPs of a character from cameras. Reading the next frame, drawing this one's tiles and encoding the previous one
// overlap.
class CameraGops : GopWork {
 public:
  CameraGops(BakeRun& run, const std::vector<ColourMap>& maps) : GopWork(run), maps_(maps) {}

  Result<uint32_t> run();
  Status runOne(const StreamPlan& plan, uint32_t gop);

 private:
  Status bakeStream(const StreamPlan& plan);
  Result<std::unique_ptr<CameraGop>> drawGop(const StreamPlan& plan, uint32_t gop, mattes::FrameReader& reader);
  Status drawFrame(CameraGop& open, const StreamPlan& plan, const mattes::CaptureFrame& frame);
  Status saveGop(CameraGop& open, const StreamPlan& plan, uint32_t gop);

  const std::vector<ColourMap>& maps_;
};

Result<uint32_t> CameraGops::run() {
  started_s_ = run_.progress.seconds();
  for (const StreamPlan& plan : job_.streams) FOURDVT_TRY(bakeStream(plan));
  return baked_;
}

Status CameraGops::runOne(const StreamPlan& plan, uint32_t gop) {
  if (isFinished(plan, gop)) return {};
  FOURDVT_ASSIGN(const auto reader, mattes::FrameReader::open(job_.capture, *plan.motion.members[0].source,
                                                              run_.environment.open_video, plan.gop_first_frames[gop]));
  FOURDVT_ASSIGN(const auto open, drawGop(plan, gop, *reader));
  return saveGop(*open, plan, gop);
}

Status CameraGops::bakeStream(const StreamPlan& plan) {
  std::unique_ptr<mattes::FrameReader> reader;
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    const uint32_t first = plan.gop_first_frames[g];
    if (isFinished(plan, g)) {
      skip(plan, g);
      continue;
    }
    if (!reader) {
      FOURDVT_ASSIGN(reader, mattes::FrameReader::open(job_.capture, *plan.motion.members[0].source,
                                                       run_.environment.open_video, first));
    } else {
      reader->skipTo(first);
    }
    FOURDVT_ASSIGN(const auto open, drawGop(plan, g, *reader));
    FOURDVT_TRY(saveGop(*open, plan, g));
    FOURDVT_TRY(run_.checkStop());
  }
  return {};
}

Result<std::unique_ptr<CameraGop>> CameraGops::drawGop(const StreamPlan& plan, uint32_t gop,
                                                       mattes::FrameReader& reader) {
  auto open = std::make_unique<CameraGop>();
  open->number = gop;
  const auto read = [&] {
    StageClock::Span span(run_.clock, Stage::Decode);
    return reader.next();
  };
  const uint32_t first = plan.gop_first_frames[gop], end = plan.gopEnd(gop);
  std::future<Result<mattes::CaptureFrame>> next = std::async(run_.lane(), read);  // futures join on every return
  for (uint32_t f = first; f < end; ++f) {
    FOURDVT_ASSIGN(const auto frame, next.get());
    if (f + 1 < end) next = std::async(run_.lane(), read);
    FOURDVT_TRY(drawFrame(*open, plan, frame));
    tellFrame(plan, f + 1);
    if (f + 1 < end) FOURDVT_TRY(run_.checkStop());
  }
  FOURDVT_TRY(open->encoding.get());
  return open;
}

Status CameraGops::drawFrame(CameraGop& open, const StreamPlan& plan, const mattes::CaptureFrame& frame) {
  const auto& tiles = plan.cameras.gops[open.number];
  std::vector<Image> drawn(tiles.size());
  std::atomic<size_t> next = 0;
  const auto drawSome = [&] {
    for (size_t c = next++; c < tiles.size(); c = next++)
      if (!tiles[c].empty())
        drawn[c] = drawCameraTile(tiles[c], frame.pictures[c], maps_.empty() ? nullptr : &maps_[c]);
  };
  {
    StageClock::Span span(run_.clock, Stage::Fill);
    std::vector<std::future<void>> others;
    for (int job = 1; job < job_.options.jobs; ++job) others.push_back(std::async(std::launch::async, drawSome));
    drawSome();
  }
  encode::I420Picture picture(plan.layout().width, plan.layout().height);
  {
    StageClock::Span span(run_.clock, Stage::Tile);
    for (size_t c = 0; c < tiles.size(); ++c)
      if (!tiles[c].empty()) encode::drawLayer(drawn[c], encode::cellsOf(tiles[c].tile), picture);
    package::drawBarcode(plan.layout().barcode, frame.index, picture.y.data(), picture.width);
  }
  const TriangleMesh surface = streamedSurface(job_, frame);
  const size_t used = std::min(surface.positions.size(), 3 * surface.faces.size());
  FOURDVT_TRY(checkSurface(meshFile(*plan.motion.members[0].source, frame.index), used, surface.faces.size()));
  open.surfaces.push_back(
      encode::quantisedSurface({glm::dvec3(job_.bounds.min), double(float(*job_.options.position_step_m))},
                               surface.positions, surface.faces, !job_.oneTopology()));
  if (open.encoding.valid()) FOURDVT_TRY(open.encoding.get());
  open.encoding = std::async(
      run_.lane(), [this, &open, &plan, index = frame.index, picture = std::move(picture), drawn = std::move(drawn)] {
        std::vector<const Image*> parts;
        for (const Image& tile : drawn)
          if (!tile.empty()) parts.push_back(&tile);
        return encode(open, plan, picture, parts, index);
      });
  return {};
}

Status CameraGops::saveGop(CameraGop& open, const StreamPlan& plan, uint32_t gop) {
  FOURDVT_TRY(finishVideos(open));
  StageClock::Span span(run_.clock, Stage::Geometry);
  auto chunk = package::encodeSurfaceChunk(plan.cameras.gops[gop], open.surfaces);
  if (!chunk)
    return Error{chunk.error().id, plan.name + ", frames " + std::to_string(plan.gop_first_frames[gop]) + " to " +
                                       std::to_string(plan.gopEnd(gop) - 1) + ": " + chunk.error().message};
  open.artefact.frames.vertex_count = chunk.value().vertex_count;
  open.artefact.frames.face_count = chunk.value().face_count;
  FOURDVT_TRY(run_.work.save(chunkFile(plan.name, gop), chunk.value().bytes));
  return run_.work.save(gopFile(plan.name, gop), open.artefact);
}

}  // namespace

Result<uint32_t> bakeGops(BakeRun& run, const Survey& survey) { return LayerGops(run, survey).run(); }
Status bakeGop(BakeRun& run, const Survey& survey, const StreamPlan& plan, uint32_t gop) {
  return LayerGops(run, survey).runOne(plan, gop);
}
Result<uint32_t> bakeGops(BakeRun& run, const std::vector<ColourMap>& maps) { return CameraGops(run, maps).run(); }
Status bakeGop(BakeRun& run, const std::vector<ColourMap>& maps, const StreamPlan& plan, uint32_t gop) {
  return CameraGops(run, maps).runOne(plan, gop);
}

}  // namespace fourdvt::bake
