// SPDX-License-Identifier: Apache-2.0
// References of a study: FVVR's pictures of the ring and at the held-out cameras, what input cameras see there, and the
// size of the foreground-only multi-view as pictures and as video (Volino and Hilton 2013, 4.2, Table 1). FVVR, the
// papers' and at its best, also draws the held-out cameras from the decoded videos, so that storage is compared at
// equal rendered quality. Memory: one frame of pictures, and a camera's encoders. Disk: the decoded pictures of the
// held-out frames.
#include <algorithm>
#include <cmath>
#include <future>

#include "bake/run/job.h"
#include "base/watch.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/codec.h"
#include "lab/study/steps/steps.h"
#include "mattes/frame_reader.h"
#include "measure/metrics.h"
#include "measure/picture_score.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr uint32_t kWholePictureEvery = 8;  // unmasked PNGs are slow and vary little

class Reference {
 public:
  Reference(const StudyContext& context, const capture::CaptureSequence& sequence, double share_before, double share)
      : context_(context), sequence_(sequence), before_(share_before), share_(share) {}

  Result<Rows> draw();
  Result<Rows> encode();

 private:
  Status drawFrame(const mattes::CaptureFrame& frame, render::Fvvr& fvvr);
  Status drawHeldOut(uint32_t frame, render::Fvvr& fvvr);
  bool isHeldOut(uint32_t frame) const;
  bool isDrawn(uint32_t frame) const;
  // Bytes and error of one camera's foreground video at every rate factor.
  struct CameraVideo {
    size_t camera = 0;
    std::vector<uint64_t> bytes;
    std::vector<SquaredError> error;
  };
  // Frames of a camera between two keyframes.
  struct CameraGop {
    uint32_t first = 0;
    std::vector<Image> pictures, colours;  // RGBA as captured, RGB as encoded
    std::vector<measure::Mask> masks;
    std::vector<std::unique_ptr<encode::GopEncoder>> encoders;  // one per rate factor
  };
  Result<CameraVideo> encodeCamera(size_t camera) const;
  Status pushGop(mattes::FrameReader& reader, uint32_t frames, CameraGop& gop) const;
  Status finishGop(CameraGop& gop, CameraVideo& out) const;
  Status takeDecoded(const CameraGop& gop, uint32_t frame, const I420View& view, size_t rate, CameraVideo& out) const;
  struct DecodedScores {
    measure::MeanScores papers, tuned;
  };
  Result<DecodedScores> scoreDecoded(int crf, render::Fvvr& fvvr) const;
  std::string decodedFolder() const { return context_.work() + "/decoded/" + sequence_.name; }
  std::string decodedPath(int crf, size_t camera, uint32_t frame) const {
    return decodedFolder() + "/" + std::to_string(crf) + "_" + std::to_string(camera) + "_" + std::to_string(frame) +
           ".png";
  }
  std::vector<int> ladder() const {
    return context_.options.quick ? std::vector{20, 36} : std::vector{18, 24, 30, 36, 42};
  }
  void tell(const std::string& what, double share) const {
    reportProgress(context_, "reference", sequence_.name + " " + what, before_ + share_ * share);
  }

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  double before_, share_;
  std::vector<RingView> ring_;
  std::vector<PinholeCamera> held_out_;
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

Status Reference::drawHeldOut(uint32_t frame, render::Fvvr& fvvr) {
  if (!isHeldOut(frame)) return {};
  for (const PinholeCamera& camera : held_out_) {
    FOURDVT_ASSIGN(const auto picture, fvvr.renderStill(render::viewFromCamera(camera), {}));
    FOURDVT_TRY(platform::writeImage(referencePath(context_, sequence_.name, camera.name, frame), picture));
    FOURDVT_ASSIGN(const auto seen, drawSeen(fvvr, camera));
    FOURDVT_TRY(platform::writeImage(seenPath(context_, sequence_.name, camera.name, frame), seen));
  }
  return {};
}

Status Reference::drawFrame(const mattes::CaptureFrame& frame, render::Fvvr& fvvr) {
  for (const RingView& view : ring_) {
    if (view.frame != frame.index) continue;
    FOURDVT_ASSIGN(auto picture, fvvr.renderStill(render::viewFromCamera(view.camera), {}));
    FOURDVT_TRY(platform::writeImage(referencePath(context_, sequence_.name, view), picture));
  }
  FOURDVT_TRY(drawHeldOut(frame.index, fvvr));
  FOURDVT_ASSIGN(const auto masked, codedBytes(frame.pictures, [](const Image& picture) {
                   return encodePng(measure::compositedOnBlack(picture));
                 }));
  masked_png_bytes_ += masked;
  for (const Image& p : frame.pictures) raw_bytes_ += 3ull * p.width * p.height;
  if (frame.index % kWholePictureEvery) return {};
  FOURDVT_ASSIGN(const auto whole, codedBytes(frame.pictures, encodePng));
  whole_png_bytes_ += whole;
  ++whole_pngs_;
  return {};
}

Result<Rows> Reference::draw() {
  FOURDVT_ASSIGN(ring_, studyRing(context_, sequence_));
  FOURDVT_ASSIGN(held_out_, heldOutCameras(context_));
  FOURDVT_TRY(platform::makeFolder(context_.work() + "/reference/" + sequence_.name));
  const uint64_t gpu_before = context_.device->counters().live_texture_bytes;
  FOURDVT_ASSIGN(auto fvvr, makeFvvr(context_));
  const Watch start;
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(*context_.capture, sequence_, context_.open_video));
  double loading_s = 0, first_s = 0;  // decoding, upload and depth maps; first: until the first picture
  uint64_t gpu_bytes = 0;
  for (uint32_t f = 0; f < sequence_.frame_count; ++f) {
    FOURDVT_TRY(checkStop(context_));
    const Watch reading = f == 0 ? start : Watch();
    FOURDVT_ASSIGN(auto frame, reader->next());
    loading_s += reading.seconds();
    cleanEdges(frame.pictures);
    const Watch showing;
    if (!context_.options.quick || isDrawn(f)) FOURDVT_TRY(fvvr->setFrame(frame.positions, frame.pictures));
    if (f == 0) {
      if (auto first = fvvr->renderStill(render::viewFromCamera(ring_[0].camera), {}); !first) return first.error();
      gpu_bytes = context_.device->counters().live_texture_bytes - gpu_before;
    }
    loading_s += showing.seconds();
    if (f == 0) first_s = loading_s;
    FOURDVT_TRY(drawFrame(frame, *fvvr));
    tell("FVVR " + std::to_string(f + 1) + "/" + std::to_string(sequence_.frame_count),
         0.5 * (f + 1) / sequence_.frame_count);
  }
  Rows out;
  const RowWriter table(out, kTable1, sequence_.name, kFvvr, "");
  table.add({{kLoadingS, first_s}});
  if (!context_.options.quick) table.add({{kLoadingAllS, loading_s}});
  table.add({{kTotalBytes, static_cast<double>(masked_png_bytes_)}});
  const RowWriter multiview(out, kMultiview, sequence_.name, kMethodMultiview,
                            "cameras=" + std::to_string(context_.capture->cameras.size()) +
                                " frames=" + std::to_string(sequence_.frame_count));
  multiview.add(
      {{kRawBytes, static_cast<double>(raw_bytes_)},
       {kCompressedBytes, static_cast<double>(whole_png_bytes_) * sequence_.frame_count / std::max(1u, whole_pngs_)},
       {kMaskedBytes, static_cast<double>(masked_png_bytes_)}});
  if (&sequence_ == &shortestSequence(context_)) {  // baseline of the layers' rows
    const RowWriter layers(out, kLayers, sequence_.name, kFvvr, "");
    layers.add({{kMaskedBytes, static_cast<double>(masked_png_bytes_) / sequence_.frame_count},
                {kGpuBytes, static_cast<double>(gpu_bytes)}});
  }
  return out;
}

// Dilates the foreground's straight colours by a few pixels into the black around it, so that neither the codec's
// ringing nor its half-resolution chroma darkens FVVR's outlines.
Image spreadColours(const Image& rgba) {
  constexpr int kSpread = 4;  // pixels
  Image out(rgba.width, rgba.height, 3);
  measure::Mask known(size_t(rgba.width) * rgba.height), next;
  for (size_t i = 0; i < known.size(); ++i) {
    known[i] = rgba.pixels[4 * i + 3] > 0;
    for (int c = 0; c < 3 && known[i]; ++c) out.pixels[3 * i + c] = rgba.pixels[4 * i + c];
  }
  for (int pass = 0; pass < kSpread; ++pass) {
    next = known;
    for (int y = 1; y + 1 < rgba.height; ++y)
      for (int x = 1; x + 1 < rgba.width; ++x) {
        const size_t i = size_t(y) * rgba.width + x;
        if (known[i]) continue;
        int sum[3] = {}, count = 0;
        for (const size_t j : {i - 1, i + 1, i - rgba.width, i + rgba.width}) {
          for (int c = 0; c < 3 && known[j]; ++c) sum[c] += out.pixels[3 * j + c];
          count += known[j] != 0;
        }
        for (int c = 0; c < 3 && count; ++c) out.pixels[3 * i + c] = static_cast<uint8_t>(sum[c] / count);
        next[i] = count > 0;
      }
    known.swap(next);
  }
  return out;
}

Status Reference::pushGop(mattes::FrameReader& reader, uint32_t frames, CameraGop& gop) const {
  encode::I420Picture picture;
  for (uint32_t f = 0; f < frames; ++f) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto frame, nextCleanFrame(reader));
    const Image& rgba = frame.pictures[0];
    const int width = rgba.width / 2 * 2, height = rgba.height / 2 * 2;
    gop.colours.push_back(spreadColours(rgba));
    gop.masks.push_back(measure::unionOfSilhouettes(rgba, rgba));
    gop.pictures.push_back(rgba);
    if (f == 0) picture = encode::I420Picture(width, height);
    for (const int crf : ladder()) {
      if (f > 0) break;
      FOURDVT_ASSIGN(auto encoder, encode::GopEncoder::create(
                                       {.width = width, .height = height, .fps = context_.capture->fps, .crf = crf}));
      gop.encoders.push_back(std::move(encoder));
    }
    encode::drawLayer(gop.colours.back(), {0, 0, width, height}, picture);
    for (auto& encoder : gop.encoders) FOURDVT_TRY(encoder->push(picture.view()));
  }
  return {};
}

// Input picture of FVVR: decoded colours with the captured matte, whose bytes are not counted. An odd last row or
// column, absent from 4:2:0, stays as captured.
Image withMatte(const Image& decoded, Image picture) {
  for (int y = 0; y < decoded.height; ++y)
    for (int x = 0; x < decoded.width; ++x) std::copy_n(decoded.at(x, y), 3, picture.at(x, y));
  return picture;
}

Status Reference::takeDecoded(const CameraGop& gop, uint32_t f, const I420View& view, size_t rate,
                              CameraVideo& out) const {
  const Image decoded = encode::rgbFromTile(view, {0, 0, view.width, view.height});
  if (decoded.width == gop.colours[f].width && decoded.height == gop.colours[f].height)
    out.error[rate].add(gop.colours[f], decoded, gop.masks[f]);
  if (held_out_.empty() || !isHeldOut(gop.first + f)) return {};
  return platform::writeImage(decodedPath(ladder()[rate], out.camera, gop.first + f),
                              withMatte(decoded, gop.pictures[f]));
}

Status Reference::finishGop(CameraGop& gop, CameraVideo& out) const {
  for (size_t i = 0; i < gop.encoders.size(); ++i) {
    auto coded = gop.encoders[i]->finish();
    gop.encoders[i].reset();
    if (!coded) return coded.error();
    out.bytes[i] += gopBytes(coded.value());
    const size_t packets = coded.value().packets.size();
    FOURDVT_ASSIGN(const size_t pictures,
                   decodeGop(encode::Codec::H264, coded.value(),
                             [&](uint32_t f, const auto& view) { return takeDecoded(gop, f, view, i, out); }));
    if (pictures != packets)
      return Error{ErrorId::VideoInvalid, "the decoder returned " + std::to_string(pictures) + " of " +
                                              std::to_string(packets) + " pictures that were encoded"};
  }
  return {};
}

Result<Reference::CameraVideo> Reference::encodeCamera(size_t camera) const {
  capture::Capture alone = *context_.capture;
  alone.cameras = {context_.capture->cameras[camera]};
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(alone, sequence_, context_.open_video));
  CameraVideo out{camera, std::vector<uint64_t>(ladder().size()), std::vector<SquaredError>(ladder().size())};
  const std::vector<uint32_t> firsts = encode::planGops(sequence_.frame_count, kStudyGop);
  for (size_t g = 0; g < firsts.size(); ++g) {
    const uint32_t end = g + 1 < firsts.size() ? firsts[g + 1] : sequence_.frame_count;
    CameraGop gop{.first = firsts[g]};
    FOURDVT_TRY(pushGop(*reader, end - firsts[g], gop));
    FOURDVT_TRY(finishGop(gop, out));
  }
  return out;
}

// Scores FVVR from the decoded videos, at the held-out cameras and frames.
Result<Reference::DecodedScores> Reference::scoreDecoded(int crf, render::Fvvr& fvvr) const {
  measure::ScoreLane papers, tuned;
  for (const uint32_t frame : sequence_.test_frames) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto positions, capture::readMeshFrame(*context_.capture, sequence_, frame));
    std::vector<Image> pictures;
    for (size_t c = 0; c < context_.capture->cameras.size(); ++c) {
      FOURDVT_ASSIGN(auto picture, platform::readImage(decodedPath(crf, c, frame)));
      pictures.push_back(std::move(picture));
    }
    FOURDVT_TRY(fvvr.setFrame(positions, pictures));
    for (const PinholeCamera& camera : held_out_) {
      FOURDVT_ASSIGN(auto truth, measure::heldOutTruth(sequence_, camera, frame));
      FOURDVT_ASSIGN(auto picture, fvvr.renderStill(render::viewFromCamera(camera), {}));
      papers.add(truth, std::move(picture));
      FOURDVT_ASSIGN(auto best, fvvr.renderStill(render::viewFromCamera(camera), render::tunedFvvr()));
      tuned.add(std::move(truth), std::move(best));
    }
  }
  return DecodedScores{papers.finishMean(), tuned.finishMean()};
}

Result<Rows> Reference::encode() {
  FOURDVT_ASSIGN(held_out_, heldOutCameras(context_));
  FOURDVT_TRY(platform::makeFolder(context_.work() + "/decoded"));
  FOURDVT_TRY(platform::makeFolder(decodedFolder()));
  const size_t count = context_.capture->cameras.size();
  const std::vector<int> crfs = ladder();
  CameraVideo sum{0, std::vector<uint64_t>(crfs.size()), std::vector<SquaredError>(crfs.size())};
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
  FOURDVT_ASSIGN(auto fvvr, makeFvvr(context_));
  Rows out;
  for (size_t i = 0; i < crfs.size(); ++i) {
    const RowWriter row(out, kMultiviewCodec, sequence_.name, "h264", "crf=" + std::to_string(crfs[i]));
    row.add({{kVideoBytes, static_cast<double>(sum.bytes[i])},
             {kVideoBps, 8 * static_cast<double>(sum.bytes[i]) * context_.capture->fps / sequence_.frame_count},
             {kPsnrFgDb, sum.error[i].psnr_db()}});
    if (held_out_.empty() || sequence_.test_frames.empty()) continue;
    FOURDVT_ASSIGN(auto scores, scoreDecoded(crfs[i], *fvvr));
    const measure::PictureScore papers = scores.papers.mean(), tuned = scores.tuned.mean();
    row.add({{kHeldOutPsnrDb, papers.psnr_fg_db},
             {kHeldOutSsim, papers.ssim_fg},
             {kTunedPsnrDb, tuned.psnr_fg_db},
             {kTunedSsim, tuned.ssim_fg}});
  }
  platform::removeFolder(decodedFolder());
  return out;
}

}  // namespace

Result<Rows> runReference(const StudyContext& context) {
  const auto sequences = studySequences(context);
  double total = 0, before = 0;
  for (const auto* sequence : sequences) total += sequence->frame_count;
  Rows out;
  for (const auto* sequence : sequences) {
    const double share = sequence->frame_count / total;
    Reference reference(context, *sequence, before, share);
    FOURDVT_TRY(addPart(
        context, "reference-" + sequence->name, [&] { return reference.draw(); }, out));
    FOURDVT_TRY(addPart(
        context, "multiview-" + sequence->name, [&] { return reference.encode(); }, out));
    before += share;
  }
  RowWriter(out, kAbout, "", "",
            "text=fourdvt-lab study CAPTURE -o REPORT" + std::string(context.options.quick ? " --quick" : ""))
      .add({{kAboutCommand, 0}});
  RowWriter(out, kAbout, "", "", "text=" + context.device->caps().renderer).add({{kAboutDevice, 0}});
  return out;
}

}  // namespace fourdvt::study
