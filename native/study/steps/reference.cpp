// SPDX-License-Identifier: Apache-2.0
// The yardsticks of a study: FVVR's pictures of the ring and at the held-out cameras, and what the foreground-only
// multi-view costs as pictures and as video (LVDT 4.2, Table 1). Memory: one frame of pictures, and a camera's
// encoders.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <map>

#include "bake/run/job.h"
#include "measure/metrics.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "study/figures.h"
#include "study/rows.h"
#include "study/run_steps.h"
#include "study/scene.h"
#include "study/steps/codec.h"

namespace fourdvt::study {
namespace {

using Clock = std::chrono::steady_clock;
constexpr uint32_t kWholePictureEvery = 8;  // unmasked PNGs cost time and vary little

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// PNG bytes of pictures, side by side on all cores.
Result<uint64_t> pngBytes(const std::vector<Image>& pictures, const std::function<Image(const Image&)>& prepare) {
  std::vector<std::future<Result<size_t>>> sizes;
  for (const Image& picture : pictures)
    sizes.push_back(std::async(std::launch::async, [&picture, &prepare]() -> Result<size_t> {
      auto png = encodePng(prepare(picture));
      if (!png) return png.error();
      return png.value().size();
    }));
  uint64_t sum = 0;
  Status first;
  for (auto& size : sizes) {
    auto bytes = size.get();
    if (bytes) sum += bytes.value();
    if (!bytes && first.ok()) first = bytes.error();
  }
  if (!first.ok()) return first.error();
  return sum;
}

class Reference {
 public:
  Reference(const StudyContext& context, const capture::CaptureSequence& sequence, double share_before, double share)
      : context_(context), sequence_(sequence), before_(share_before), share_(share) {}

  Result<Figures> draw();
  Result<Figures> encode();

 private:
  Status drawFrame(const capture::CaptureFrame& frame, render::Fvvr& fvvr);
  Status heldOut(uint32_t frame, render::Fvvr& fvvr);
  bool isHeldOut(uint32_t frame) const;
  bool isDrawn(uint32_t frame) const;
  // Bytes and error of one camera's masked video at every rate factor.
  struct CameraVideo {
    std::vector<uint64_t> bytes;
    std::vector<SquaredError> error;
  };
  Result<CameraVideo> encodeCamera(size_t camera) const;
  Status encodeGop(capture::FrameReader& reader, uint32_t frames, CameraVideo& out) const;
  std::vector<int> ladder() const { return context_.options.quick ? std::vector{20, 28} : std::vector{18, 23, 28, 33}; }
  void tell(const std::string& what, double share) const {
    if (context_.progress) context_.progress({"reference", sequence_.name + " " + what, before_ + share_ * share});
  }

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  double before_, share_;
  std::vector<RingView> ring_;
  std::vector<PinholeCamera> held_out_;
  MeanScores held_out_scores_, held_out_closest_;
  std::map<std::string, MeanScores> held_out_by_camera_;
  uint64_t masked_png_bytes_ = 0, whole_png_bytes_ = 0, raw_bytes_ = 0;
  uint32_t whole_pngs_ = 0;
};

bool Reference::isHeldOut(uint32_t frame) const {
  const auto& test = sequence_.test_frames;
  return std::find(test.begin(), test.end(), frame) != test.end();
}

bool Reference::isDrawn(uint32_t frame) const {
  return frame == 0 || isHeldOut(frame) ||
         std::any_of(ring_.begin(), ring_.end(), [&](const RingView& view) { return view.frame == frame; });
}

Status Reference::heldOut(uint32_t frame, render::Fvvr& fvvr) {
  if (!isHeldOut(frame)) return {};
  for (const PinholeCamera& camera : held_out_) {
    auto truth = heldOutTruth(sequence_, camera, frame);
    if (!truth) return truth.error();
    auto picture = fvvr.renderStill(render::viewFromCamera(camera), {});
    if (!picture) return picture.error();
    const PictureScore score = scorePicture(truth.value(), picture.value());
    auto fewer = fvvr.renderStill(render::viewFromCamera(camera), {.closest = rows::kClosestCameras});
    if (!fewer) return fewer.error();
    held_out_closest_.add(scorePicture(truth.value(), fewer.value()));
    held_out_scores_.add(score);
    held_out_by_camera_[camera.name].add(score);
    FOURDVT_TRY(platform::writeImage(referencePath(context_, sequence_.name, camera.name, frame), picture.value()));
  }
  return {};
}

Status Reference::drawFrame(const capture::CaptureFrame& frame, render::Fvvr& fvvr) {
  for (const RingView& view : ring_) {
    if (view.frame != frame.index) continue;
    auto picture = fvvr.renderStill(render::viewFromCamera(view.camera), {});
    if (!picture) return picture.error();
    FOURDVT_TRY(platform::writeImage(referencePath(context_, sequence_.name, view), picture.value()));
  }
  FOURDVT_TRY(heldOut(frame.index, fvvr));
  auto masked = pngBytes(frame.pictures, measure::compositedOnBlack);
  if (!masked) return masked.error();
  masked_png_bytes_ += masked.value();
  for (const Image& p : frame.pictures) raw_bytes_ += 3ull * p.width * p.height;
  if (frame.index % kWholePictureEvery) return {};
  auto whole = pngBytes(frame.pictures, [](const Image& picture) { return picture; });
  if (!whole) return whole.error();
  whole_png_bytes_ += whole.value();
  ++whole_pngs_;
  return {};
}

Result<Figures> Reference::draw() {
  auto ring = studyRing(context_, sequence_);
  if (!ring) return ring.error();
  ring_ = ring.take();
  auto held_out = heldOutCameras(context_);
  if (!held_out) return held_out.error();
  held_out_ = held_out.take();
  FOURDVT_TRY(platform::makeFolder(context_.work() + "/reference/" + sequence_.name));
  const uint64_t gpu_before = context_.device->counters().live_texture_bytes;
  auto fvvr = makeFvvr(context_);
  if (!fvvr) return fvvr.error();
  const auto start = Clock::now();
  auto reader = capture::FrameReader::open(*context_.capture, sequence_, context_.open_video);
  if (!reader) return reader.error();
  double loading_s = 0, first_s = 0;  // decoding, upload and depth maps; first: until the first picture
  uint64_t gpu_bytes = 0;
  for (uint32_t f = 0; f < sequence_.frame_count; ++f) {
    FOURDVT_TRY(checkStop(context_));
    const auto reading = f == 0 ? start : Clock::now();
    auto frame = reader.value()->next();
    if (!frame) return frame.error();
    loading_s += secondsSince(reading);
    cleanEdges(frame.value().pictures);
    const auto showing = Clock::now();
    if (!context_.options.quick || isDrawn(f))
      FOURDVT_TRY(fvvr.value()->setFrame(frame.value().positions, frame.value().pictures));
    if (f == 0) {
      if (auto first = fvvr.value()->renderStill(render::viewFromCamera(ring_[0].camera), {}); !first)
        return first.error();
      gpu_bytes = context_.device->counters().live_texture_bytes - gpu_before;
    }
    loading_s += secondsSince(showing);
    if (f == 0) first_s = loading_s;
    FOURDVT_TRY(drawFrame(frame.value(), *fvvr.value()));
    tell("FVVR " + std::to_string(f + 1) + "/" + std::to_string(sequence_.frame_count),
         0.5 * (f + 1) / sequence_.frame_count);
  }
  Figures out;
  const RowWriter table(out, rows::kTable1, sequence_.name, rows::kFvvr, "");
  table.add(rows::kLoadingS, first_s, "s");
  if (!context_.options.quick) table.add("loading_all_s", loading_s, "s");
  table.add(rows::kTotalBytes, static_cast<double>(masked_png_bytes_), "bytes");
  const RowWriter multiview(out, rows::kMultiview, sequence_.name, rows::kMethodMultiview,
                            "cameras=" + std::to_string(context_.capture->cameras.size()) +
                                " frames=" + std::to_string(sequence_.frame_count));
  multiview.add(rows::kRawBytes, static_cast<double>(raw_bytes_), "bytes");
  multiview.add(rows::kCompressedBytes,
                static_cast<double>(whole_png_bytes_) * sequence_.frame_count / std::max(1u, whole_pngs_), "bytes");
  multiview.add(rows::kMaskedBytes, static_cast<double>(masked_png_bytes_), "bytes");
  if (&sequence_ == &shortestSequence(context_)) {  // what the layers' figures are compared with
    const RowWriter layers(out, rows::kLayers, sequence_.name, rows::kFvvr, "");
    layers.add(rows::kMaskedBytes, static_cast<double>(masked_png_bytes_) / sequence_.frame_count, "bytes");
    layers.add(rows::kGpuBytes, static_cast<double>(gpu_bytes), "bytes");
  }
  held_out_scores_.write(out, rows::kHeldOut, sequence_.name, rows::kFvvr,
                         "views=" + std::to_string(held_out_scores_.count()));
  held_out_closest_.write(out, rows::kHeldOut, sequence_.name, rows::kFvvrClosest,
                          "views=" + std::to_string(held_out_closest_.count()));
  for (const auto& [camera, scores] : held_out_by_camera_)
    scores.write(out, "held-out-views", sequence_.name, rows::kFvvr, "view=" + camera);
  return out;
}

Status Reference::encodeGop(capture::FrameReader& reader, uint32_t frames, CameraVideo& out) const {
  const std::vector<int> crfs = ladder();
  std::vector<std::unique_ptr<bake::GopEncoder>> encoders;
  std::vector<Image> sources;  // masked, on black
  std::vector<measure::Mask> masks;
  bake::I420Picture picture;
  for (uint32_t f = 0; f < frames; ++f) {
    FOURDVT_TRY(checkStop(context_));
    auto frame = nextCleanFrame(reader);
    if (!frame) return frame.error();
    const Image& rgba = frame.value().pictures[0];
    const int width = rgba.width / 2 * 2, height = rgba.height / 2 * 2;
    sources.push_back(measure::compositedOnBlack(rgba));
    masks.push_back(measure::unionOfSilhouettes(rgba, rgba));
    if (f == 0) picture = bake::I420Picture(width, height);
    bake::drawLayer(sources.back(), {0, 0, width, height}, picture);
    for (size_t i = 0; i < crfs.size(); ++i) {
      if (f == 0) {
        auto encoder =
            bake::GopEncoder::create({.width = width, .height = height, .fps = context_.capture->fps, .crf = crfs[i]});
        if (!encoder) return encoder.error();
        encoders.push_back(encoder.take());
      }
      FOURDVT_TRY(encoders[i]->push(picture.view()));
    }
  }
  for (size_t i = 0; i < crfs.size(); ++i) {
    auto gop = encoders[i]->finish();
    encoders[i].reset();
    if (!gop) return gop.error();
    out.bytes[i] += gopBytes(gop.value());
    FOURDVT_TRY(decodeGop(gop.value(), [&](uint32_t f, const I420View& view) -> Status {
      Image decoded = bake::rgbFromTile(view, {0, 0, view.width, view.height});
      if (decoded.width == sources[f].width && decoded.height == sources[f].height)
        out.error[i].add(sources[f], decoded, masks[f]);
      return {};
    }));
  }
  return {};
}

Result<Reference::CameraVideo> Reference::encodeCamera(size_t camera) const {
  capture::Capture alone = *context_.capture;
  alone.cameras = {context_.capture->cameras[camera]};
  auto reader = capture::FrameReader::open(alone, sequence_, context_.open_video);
  if (!reader) return reader.error();
  CameraVideo out{std::vector<uint64_t>(ladder().size()), std::vector<SquaredError>(ladder().size())};
  const std::vector<uint32_t> firsts = bake::planGops(sequence_.frame_count, kStudyGop);
  for (size_t g = 0; g < firsts.size(); ++g) {
    const uint32_t end = g + 1 < firsts.size() ? firsts[g + 1] : sequence_.frame_count;
    FOURDVT_TRY(encodeGop(*reader.value(), end - firsts[g], out));
  }
  return out;
}

Result<Figures> Reference::encode() {
  const size_t count = context_.capture->cameras.size();
  const std::vector<int> crfs = ladder();
  CameraVideo sum{std::vector<uint64_t>(crfs.size()), std::vector<SquaredError>(crfs.size())};
  const size_t lanes = context_.options.jobs == 1 ? 1 : 2;
  for (size_t c = 0; c < count; c += lanes) {
    std::vector<std::future<Result<CameraVideo>>> running;
    for (size_t k = c; k < std::min(count, c + lanes); ++k)
      running.push_back(std::async(std::launch::async, [this, k] { return encodeCamera(k); }));
    std::vector<Result<CameraVideo>> finished;
    for (auto& video : running) finished.push_back(video.get());
    for (auto& video : finished) {
      if (!video) return video.error();
      for (size_t i = 0; i < crfs.size(); ++i) {
        sum.bytes[i] += video.value().bytes[i];
        sum.error[i].add(video.value().error[i]);
      }
    }
    tell("foreground videos", 0.5 + 0.5 * static_cast<double>(std::min(count, c + lanes)) / count);
  }
  Figures out;
  for (size_t i = 0; i < crfs.size(); ++i) {
    const RowWriter row(out, "multiview-codec", sequence_.name, "h264", "crf=" + std::to_string(crfs[i]));
    row.add(rows::kVideoBytes, static_cast<double>(sum.bytes[i]), "bytes");
    row.add(rows::kPsnrFgDb, sum.error[i].psnr_db(), "dB");
  }
  return out;
}

}  // namespace

Result<Figures> runReference(const StudyContext& context) {
  const auto sequences = studySequences(context);
  double total = 0, before = 0;
  for (const auto* sequence : sequences) total += sequence->frame_count;
  Figures out;
  for (const auto* sequence : sequences) {
    const double share = sequence->frame_count / total;
    Reference reference(context, *sequence, before, share);
    auto drawn = keptPart(context, "reference-" + sequence->name, [&] { return reference.draw(); });
    if (!drawn) return drawn;
    auto encoded = keptPart(context, "multiview-" + sequence->name, [&] { return reference.encode(); });
    if (!encoded) return encoded;
    out.insert(out.end(), drawn.value().begin(), drawn.value().end());
    out.insert(out.end(), encoded.value().begin(), encoded.value().end());
    before += share;
  }
  RowWriter(out, rows::kAbout, "", "",
            "text=fourdvt evaluate CAPTURE -o REPORT" + std::string(context.options.quick ? " --quick" : ""))
      .add(rows::kAboutCommand, 0, "");
  RowWriter(out, rows::kAbout, "", "", "text=" + context.device->caps().renderer).add(rows::kAboutDevice, 0, "");
  return out;
}

}  // namespace fourdvt::study
