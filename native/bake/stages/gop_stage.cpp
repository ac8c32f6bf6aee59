// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/gop_stage.h"

#include "bake/stages/poster.h"

namespace fourdvt::bake {
namespace {

double frameWork(const StreamPlan& plan) { return StageWork::kFrame * plan.motion.members.size(); }

// Means of equal blocks; the side of layer 1 is a multiple of kAtlasSide.
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

}  // namespace

struct GopStage::OpenGop {
  std::unique_ptr<GopEncoder> encoder;  // made with the first frame
  ChunkBuilder chunk;
  GopArtefact artefact;
};

Status GopStage::start() {
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
  chunk_mesh_ = package::makeChunkMesh(mesh);
  return {};
}

Status GopStage::run() {
  started_s_ = progress_.seconds();
  for (const StreamPlan& plan : job_.streams) FOURDVT_TRY(bakeStream(plan));
  return waitForSave();
}

bool GopStage::isFinished(const StreamPlan& plan, uint32_t gop) const {
  if (!work_.hasGop(plan.name, gop)) return false;
  if (!plan.isClass() && !work_.hasChunk(plan.name, gop)) return false;
  return !isFirst(plan) || gop > 0 || work_.hasStill();
}

Status GopStage::bakeStream(const StreamPlan& plan) {
  std::unique_ptr<StreamReader> reader;  // stays open over neighbouring GOPs
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    if (isFinished(plan, g)) {
      const uint32_t frames = plan.gopEnd(g) - plan.gop_first_frames[g];
      progress_.frames_done += frames;
      progress_.skip(frames * frameWork(plan));
      reader.reset();
      continue;
    }
    if (!reader) {
      auto made = StreamReader::create(job_, plan, environment_.open_video, clock_);
      if (!made) return made.error();
      reader = made.take();
      looks_.assign(plan.motion.members.size(), {});
      picture_ = I420Picture(plan.layout.width, plan.layout.height);
    }
    FOURDVT_TRY(bakeGop(plan, g, *reader));
    if (progress_.stopped()) FOURDVT_TRY(waitForSave());  // on every lane: a finished GOP is kept
    FOURDVT_TRY(checkStop(environment_, work_.path()));
  }
  return {};
}

Status GopStage::bakeGop(const StreamPlan& plan, uint32_t gop, StreamReader& reader) {
  auto open = std::make_unique<OpenGop>(OpenGop{nullptr, ChunkBuilder(job_, plan), {}});
  const uint32_t first = plan.gop_first_frames[gop], end = plan.gopEnd(gop);
  const auto read = [&](uint32_t frame) { return reader.read(frame); };
  std::future<Result<PreparedFrame>> next = std::async(lane(), read, first);  // futures join on every way out
  std::future<Status> finished;
  for (uint32_t f = first; f < end; ++f) {
    auto prepared = next.get();
    if (!prepared) return prepared.error();
    if (f + 1 < end) next = std::async(lane(), read, f + 1);
    auto drawn = drawFrame(plan, prepared.take());
    if (!drawn) return drawn.error();
    FOURDVT_TRY(f == first ? waitForSave() : finished.get());
    finished = std::async(lane(), [this, &open = *open, &plan, f, frame = drawn.take()]() mutable {
      return finishFrame(open, plan, std::move(frame), f);
    });
    tellFrame(plan, f + 1);
    if (f + 1 < end) FOURDVT_TRY(checkStop(environment_, work_.path()));
  }
  FOURDVT_TRY(finished.get());
  saving_ = std::async(lane(), [this, &plan, gop, open = std::move(open)] { return saveGop(*open, plan, gop); });
  return {};
}

Status GopStage::waitForSave() { return saving_.valid() ? saving_.get() : Status(); }

Result<GopStage::DrawnFrame> GopStage::drawFrame(const StreamPlan& plan, PreparedFrame frame) {
  DrawnFrame out;
  for (size_t m = 0; m < frame.members.size(); ++m) {
    const PreparedMember& member = frame.members[m];
    out.members.emplace_back();
    if (!member.fresh) continue;
    auto look = drawMember(job_.planOf(*plan.motion.members[m].source), member.source_frame, *member.fresh);
    if (!look) return look.error();
    out.members.back() = look.take();
  }
  out.geometry = std::move(frame.geometry);
  return out;
}

Result<GopStage::MemberLook> GopStage::drawMember(const SequencePlan& plan, uint32_t source_frame,
                                                  const SourceFrame& source) {
  MemberLook out;
  auto labels = survey_.labels(plan, source_frame);
  if (!labels) return labels.error();
  out.labels = labels.take();
  StageClock::Span span(clock_, "resample");
  frames_->setFrame(source.pose, source.crops);
  if (job_.options.labels == LabelMode::PerTexel) {
    auto order = survey_.penaltyOrder(plan, source_frame);
    if (!order) return order.error();
    auto layers = frames_->resamplePerTexel(order.value());
    if (!layers) return layers.error();
    out.layers = layers.take();
  } else {
    auto layers = frames_->resample(out.labels);
    if (!layers) return layers.error();
    out.layers = layers.take();
  }
  return out;
}

Status GopStage::finishFrame(OpenGop& open, const StreamPlan& plan, DrawnFrame frame, uint32_t index) {
  for (size_t m = 0; m < looks_.size(); ++m) {
    if (!frame.members[m]) continue;
    StageClock::Span span(clock_, "fill");
    looks_[m] = std::move(*frame.members[m]);
    frames_->fill(looks_[m].layers);
    looks_[m].atlas = atlasOf(looks_[m].layers[0]);
  }
  std::vector<const Image*> layers;
  std::vector<uint8_t> labels;
  for (const MemberLook& look : looks_) {
    for (const Image& layer : look.layers) layers.push_back(&layer);
    labels.insert(labels.end(), look.labels.begin(), look.labels.end());
    open.artefact.atlases.push_back(look.atlas);
  }
  {
    StageClock::Span span(clock_, "tile");
    tileFrame(plan.layout, layers, index, picture_);
  }
  open.chunk.add(frame.geometry, labels);
  if (index == 0 && isFirst(plan)) FOURDVT_TRY(saveStill());
  return encode(open, plan);
}

Status GopStage::encode(OpenGop& open, const StreamPlan& plan) {
  StageClock::Span span(clock_, "encode");
  if (!open.encoder) {
    auto encoder = GopEncoder::create(plan.encode);
    if (!encoder) return encoder.error();
    open.encoder = encoder.take();
    if (plan.isClass()) {
      auto jpeg = encodePicture(rgbFromTile(picture_.view(), {0, 0, picture_.width, picture_.height}), ".jpg", 80);
      if (!jpeg) return jpeg.error();
      open.artefact.picture_jpeg = jpeg.take();
    }
  }
  return open.encoder->push(picture_.view());
}

Status GopStage::saveStill() {
  StageClock::Span span(clock_, "assemble");
  auto texture = encodePicture(rgbFromTile(picture_.view(), job_.layout.layers[0]), ".jpg", 90);
  if (!texture) return texture.error();
  const Image tiles = rgbFromTile(picture_.view(), {0, 0, picture_.width, picture_.height});
  auto tile_jpeg = encodePicture(tiles, ".jpg", 80);
  if (!tile_jpeg) return tile_jpeg.error();
  return work_.saveStill({picture_, looks_[0].labels, texture.take(), tile_jpeg.take()});
}

Status GopStage::saveGop(OpenGop& open, const StreamPlan& plan, uint32_t gop) {
  {
    StageClock::Span span(clock_, "encode");
    auto video = open.encoder->finish();
    if (!video) return video.error();
    open.artefact.video = video.take();
    open.encoder.reset();
  }
  StageClock::Span span(clock_, "geometry");
  package::ChunkFrames frames = open.chunk.finish();
  if (plan.isClass()) {
    open.artefact.frames = std::move(frames);
  } else {
    auto chunk = package::encodeChunk(frames, chunk_mesh_);
    if (!chunk) return chunk.error();
    FOURDVT_TRY(work_.saveChunk(plan.name, gop, chunk.value()));
  }
  return work_.saveGop(plan.name, gop, open.artefact);
}

void GopStage::tellFrame(const StreamPlan& plan, uint32_t frame) {
  ++progress_.frames_done;
  ++baked_;
  progress_.worked(frameWork(plan));
  const double elapsed = progress_.seconds() - started_s_;
  progress_.tell(plan.name + " " + std::to_string(frame) + "/" + std::to_string(plan.frameCount()),
                 elapsed > 0 ? baked_ / elapsed : 0);
}

}  // namespace fourdvt::bake
