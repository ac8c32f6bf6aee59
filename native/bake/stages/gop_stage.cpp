// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/gop_stage.h"

#include "bake/run/renditions.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

double frameWork(const Job& job, const StreamPlan& plan) {
  return encodeWork(job.options) * double(plan.motion.members.size());
}

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

// [frame] of a captured sequence's stream: whether a class shows it.
std::vector<bool> shownByClasses(const Job& job, const StreamPlan& plan) {
  std::vector<bool> shown(plan.frameCount(), false);
  if (plan.isClass()) return shown;
  for (const StreamPlan& other : job.streams)
    for (size_t m = 0; other.isClass() && m < other.motion.members.size(); ++m)
      for (uint32_t f = 0; other.motion.members[m].source->name == plan.name && f < other.frameCount(); ++f)
        shown[other.sourceFrame(m, f)] = true;
  return shown;
}

}  // namespace

struct GopStage::OpenGop {
  uint32_t number = 0;
  std::unique_ptr<LadderEncoder> encoder;  // made with the first frame
  ChunkBuilder chunk;
  GopArtefact artefact;
};

Status GopStage::start() {
  StageClock::Span span(run_.clock, Stage::Fill);  // the gutter maps are most of it
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

Status GopStage::run() {
  FOURDVT_TRY(start());
  started_s_ = run_.progress.seconds();
  for (const StreamPlan& plan : job_.streams) FOURDVT_TRY(bakeStream(plan));
  run_.work.removeLayers();
  return waitForSave();
}

bool GopStage::isFinished(const StreamPlan& plan, uint32_t gop) const {
  if (!run_.work.has(gopFile(plan.name, gop))) return false;
  if (!plan.isClass() && !run_.work.has(chunkFile(plan.name, gop))) return false;
  return !isFirst(plan) || gop > 0 || run_.work.has(kStillFile);
}

Status GopStage::runOne(const StreamPlan& plan, uint32_t gop) {
  if (isFinished(plan, gop)) return {};
  FOURDVT_TRY(start());
  FOURDVT_ASSIGN(const auto reader, openStream(plan));
  FOURDVT_TRY(bakeGop(plan, gop, *reader));
  return waitForSave();
}

Result<std::unique_ptr<StreamReader>> GopStage::openStream(const StreamPlan& plan) {
  FOURDVT_ASSIGN(auto reader, StreamReader::create(run_, plan));
  looks_.assign(plan.motion.members.size(), {});
  kept_ = shownByClasses(job_, plan);
  picture_ = encode::I420Picture(plan.layout().width, plan.layout().height);
  return reader;
}

Status GopStage::bakeStream(const StreamPlan& plan) {
  std::unique_ptr<StreamReader> reader;  // stays open over neighbouring GOPs
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    if (isFinished(plan, g)) {
      const uint32_t frames = plan.gopEnd(g) - plan.gop_first_frames[g];
      run_.progress.frames_done += frames;
      run_.progress.skip(frames * frameWork(job_, plan));
      reader.reset();
      continue;
    }
    if (!reader) {
      FOURDVT_ASSIGN(reader, openStream(plan));
    }
    FOURDVT_TRY(bakeGop(plan, g, *reader));
    if (run_.stopped()) FOURDVT_TRY(waitForSave());  // on every lane: a finished GOP is kept
    FOURDVT_TRY(run_.checkStop());
  }
  return {};
}

Status GopStage::bakeGop(const StreamPlan& plan, uint32_t gop, StreamReader& reader) {
  auto open = std::make_unique<OpenGop>(OpenGop{gop, nullptr, ChunkBuilder(job_, plan), {}});
  const uint32_t first = plan.gop_first_frames[gop], end = plan.gopEnd(gop);
  const auto read = [&](uint32_t frame) { return reader.read(frame); };
  std::future<Result<PreparedFrame>> next = std::async(lane(), read, first);  // futures join on every way out
  std::future<Status> finished;
  for (uint32_t f = first; f < end; ++f) {
    FOURDVT_ASSIGN(auto prepared, next.get());
    if (f + 1 < end) next = std::async(lane(), read, f + 1);
    FOURDVT_ASSIGN(auto drawn, drawFrame(plan, std::move(prepared)));
    FOURDVT_TRY(f == first ? waitForSave() : finished.get());
    finished = std::async(lane(), [this, &open = *open, &plan, f, frame = std::move(drawn)]() mutable {
      return finishFrame(open, plan, std::move(frame), f);
    });
    tellFrame(plan, f + 1);
    if (f + 1 < end) FOURDVT_TRY(run_.checkStop());
  }
  FOURDVT_TRY(finished.get());
  saving_ = std::async(lane(), [this, &plan, gop, open = std::move(open)] { return saveGop(*open, plan, gop); });
  return {};
}

Status GopStage::waitForSave() { return saving_.valid() ? saving_.get() : Status(); }

Result<GopStage::DrawnFrame> GopStage::drawFrame(const StreamPlan& plan, PreparedFrame frame) {
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

Result<GopStage::MemberLook> GopStage::drawMember(const capture::CaptureSequence& sequence, uint32_t source_frame,
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

Result<GopStage::MemberLook> GopStage::keptMember(const capture::CaptureSequence& sequence, PreparedMember kept) const {
  MemberLook out;
  FOURDVT_ASSIGN(out.labels, survey_.labels(sequence, kept.source_frame));
  out.layers = std::move(kept.kept_layers);
  out.filled = true;
  return out;
}

// A disk that is full of them must not end the bake: without them the class draws its frames itself.
void GopStage::keepForClasses(const StreamPlan& plan, uint32_t frame) {
  if (!kept_[frame] || run_.work.save(layersFile(plan.name, frame), looks_[0].layers, store::Written::ToCache).ok())
    return;
  kept_.assign(kept_.size(), false);
  run_.work.removeLayers();
}

Status GopStage::finishFrame(OpenGop& open, const StreamPlan& plan, DrawnFrame frame, uint32_t index) {
  for (size_t m = 0; m < looks_.size(); ++m) {
    if (!frame.members[m]) continue;
    StageClock::Span span(run_.clock, Stage::Fill);
    looks_[m] = std::move(*frame.members[m]);
    if (!looks_[m].filled) frames_->fill(looks_[m].layers);
    looks_[m].atlas = atlasOf(looks_[m].layers[0]);
  }
  keepForClasses(plan, index);
  std::vector<const Image*> layers;
  std::vector<uint8_t> labels;
  for (const MemberLook& look : looks_) {
    for (const Image& layer : look.layers) layers.push_back(&layer);
    labels.insert(labels.end(), look.labels.begin(), look.labels.end());
    open.artefact.atlases.push_back(look.atlas);
  }
  {
    StageClock::Span span(run_.clock, Stage::Tile);
    encode::tileFrame(plan.layout(), layers, index, picture_);
  }
  open.chunk.add(frame.geometry, labels);
  if (index == 0 && isFirst(plan)) FOURDVT_TRY(saveStill());
  return encode(open, plan, layers, index);
}

Status GopStage::encode(OpenGop& open, const StreamPlan& plan, const std::vector<const Image*>& layers,
                        uint32_t index) {
  StageClock::Span span(run_.clock, Stage::Encode);
  if (!open.encoder) {
    FOURDVT_ASSIGN(open.encoder, LadderEncoder::create(plan, open.number, lane()));
    if (plan.isClass()) {
      FOURDVT_ASSIGN(open.artefact.picture_jpeg,
                     platform::encodeImage(
                         encode::rgbFromTile(picture_.view(), {0, 0, picture_.width, picture_.height}), ".jpg", 80));
    }
  }
  return open.encoder->push(picture_.view(), layers, index);
}

Status GopStage::saveStill() {
  StageClock::Span span(run_.clock, Stage::Assemble);
  FOURDVT_ASSIGN(auto texture,
                 platform::encodeImage(encode::rgbFromTile(picture_.view(), job_.layout.layers[0]), ".jpg", 90));
  const Image tiles = encode::rgbFromTile(picture_.view(), {0, 0, picture_.width, picture_.height});
  FOURDVT_ASSIGN(auto tile_jpeg, platform::encodeImage(tiles, ".jpg", 80));
  return run_.work.save(kStillFile,
                        StillArtefact{picture_, looks_[0].labels, std::move(texture), std::move(tile_jpeg)});
}

Status GopStage::saveGop(OpenGop& open, const StreamPlan& plan, uint32_t gop) {
  {
    StageClock::Span span(run_.clock, Stage::Encode);
    FOURDVT_ASSIGN(open.artefact.videos, open.encoder->finish());
    open.encoder.reset();
  }
  StageClock::Span span(run_.clock, Stage::Geometry);
  package::ChunkFrames frames = open.chunk.finish();
  if (plan.isClass()) {
    open.artefact.frames = std::move(frames);
  } else {
    FOURDVT_TRY(saveChunks(run_, plan, gop, frames, chunk_mesh_));
  }
  return run_.work.save(gopFile(plan.name, gop), open.artefact);
}

void GopStage::tellFrame(const StreamPlan& plan, uint32_t frame) {
  ++run_.progress.frames_done;
  ++baked_;
  run_.progress.worked(frameWork(job_, plan));
  const double elapsed = run_.progress.seconds() - started_s_;
  run_.progress.tell(plan.name + " " + std::to_string(frame) + "/" + std::to_string(plan.frameCount()),
                     elapsed > 0 ? baked_ / elapsed : 0);
}

}  // namespace fourdvt::bake
