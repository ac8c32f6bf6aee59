// SPDX-License-Identifier: Apache-2.0
// Volino and Hilton 2013 Fig. 5-7, Casas et al. 2014 Fig. 9: fidelity to FVVR, storage and GPU memory against the
// number of layers and their size, for layers of equal size, on the shortest sequence (colours calibrated on it alone).
// `joint` is solved per number of layers. `naive` is solved once, because its first layers are independent of that
// number. Fidelity is measured before any codec. Memory: one frame of pictures, the 4:2:0 layers of one GOP (2.6 GB at
// 2048 texels), and the FVVR pictures of the views (36 at most).
#include <algorithm>
#include <cmath>
#include <future>
#include <map>

#include "lab/labels/paper_labellings.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/codec.h"
#include "lab/study/steps/layers_drawing.h"
#include "lab/study/steps/steps.h"
#include "mattes/frame_reader.h"
#include "measure/picture_score.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr int kJpegQuality = 95, kErrorMapLayers = 3;

// Point of a curve: labels of one method for one number of layers.
struct LayerVariant {
  std::string method;
  int layers = 0;
  const SurveyedJob* labels = nullptr;
  bool stored = false;  // also stored as pictures and video
  std::string setting(int size) const { return "layers=" + std::to_string(layers) + " size=" + std::to_string(size); }
};

struct Plan {
  int frames = 6, views = 6;  // frames drawn, views of each; 0 frames: encoding only
  uint32_t video_frames = 0;  // frames encoded as video; 0: drawing only
  int max_layers = 6;
  std::vector<int> sizes{256, 512, 1024, 2048};
};

enum class LayerOutput { Drawn, Encoded };

Plan planFor(const StudyContext& context, uint32_t frame_count, LayerOutput output) {
  Plan plan;
  plan.video_frames = frame_count;
  const int cameras = static_cast<int>(context.capture->cameras.size());
  if (context.options.quick) {
    plan = {3, 4, std::min(frame_count, 8u), 3, {256, 512, 1024}};
  }
  plan.max_layers = std::min(plan.max_layers, cameras);
  plan.frames = std::min<int>(plan.frames, static_cast<int>(frame_count));
  if (output == LayerOutput::Drawn)
    plan.video_frames = 0;
  else
    plan.frames = 0;
  return plan;
}

// Bytes of one variant's layers, summed over the encoded frames.
struct Stored {
  uint64_t png = 0, jpeg = 0, video = 0;
  uint32_t pictures_of = 0;  // frames
};

struct Shown {
  measure::MeanScores scores;
  Stored stored;
  double gpu_bytes = 0;
};

class LayerStudy {
 public:
  LayerStudy(const StudyContext& context, LayerOutput output)
      : context_(context),
        sequence_(shortestSequence(context)),
        plan_(planFor(context, sequence_.frame_count, output)),
        name_(output == LayerOutput::Drawn ? "layers" : "layer-videos") {}
  Result<Rows> run();

 private:
  Status survey();
  Status drawReferences();
  Result<Rows> measureSize(int size, double before, double share);
  std::vector<LayerVariant> variantsOf(int size) const;
  Status addFrame(const LayerVariant& variant, int size, uint32_t frame, std::vector<Image> layers);
  Status drawViews(const LayerVariant& variant, int size, uint32_t frame, const std::vector<Image>& layers);
  Status saveErrorMap(const LayerVariant& variant, int size, uint32_t frame, const Image& reference,
                      const Image& picture);
  Status addPictures(const std::vector<Image>& layers, Stored& stored);
  Status encodeGop(const std::vector<LayerVariant>& variants, int size);
  Result<std::vector<uint8_t>> labelsOf(const LayerVariant& variant, uint32_t frame) const;
  bool isDrawn(uint32_t frame) const { return views_.count(frame) > 0; }
  const bake::Job& job() const { return naive_->job; }

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  Plan plan_;
  const std::string name_;  // step name
  std::unique_ptr<SurveyedJob> naive_;
  std::map<int, std::unique_ptr<SurveyedJob>> joint_;     // by number of layers
  std::map<uint32_t, std::vector<PinholeCamera>> views_;  // by frame
  std::map<uint32_t, std::vector<Image>> references_;     // by frame
  // State of the current size, by variant.
  std::map<std::string, Shown> shown_;
  std::map<std::string, std::vector<std::vector<encode::I420Picture>>> gop_;  // [layer][frame]
  std::unique_ptr<LayerDrawing> drawing_;
  measure::ScoreLane lane_;
  bool has_error_map_ = false;
  Rows pictures_;
};

std::string keyOf(const LayerVariant& variant) { return variant.method + " " + std::to_string(variant.layers); }

Status LayerStudy::survey() {
  bake::BakeOptions options = studyBake(context_, "layers");
  options.sequences = {sequence_.name};
  options.texture = 128;  // for the plan only: this step has its own sizes
  lab::useLabelling(lab::kNaive, options);
  options.layers = plan_.max_layers;
  FOURDVT_ASSIGN(naive_, surveyOnly(context_, options));
  lab::useLabelling(bake::kJoint, options);
  for (int l = 1; l <= plan_.max_layers; ++l) {
    FOURDVT_TRY(checkStop(context_));
    options.layers = l;
    FOURDVT_ASSIGN(joint_[l], surveyOnly(context_, options));
    reportProgress(context_, name_, "labels of " + std::to_string(l) + " layers", 0.1 * l / plan_.max_layers);
  }
  return {};
}

// Draws views j, j + n, j + 2n … of the ring for the j-th drawn frame: all frames together cover the ring once.
Status LayerStudy::drawReferences() {
  FOURDVT_ASSIGN(auto ring, studyRing(context_, sequence_));
  for (int j = 0; j < plan_.frames; ++j) {
    const auto frame = static_cast<uint32_t>(static_cast<uint64_t>(j) * sequence_.frame_count / plan_.frames);
    for (int k = 0; k < plan_.views; ++k) views_[frame].push_back(ring[(j + k * plan_.frames) % ring.size()].camera);
  }
  FOURDVT_ASSIGN(auto fvvr, makeFvvr(context_));
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(*context_.capture, sequence_, context_.open_video));
  for (uint32_t f = 0; f <= views_.rbegin()->first; ++f) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto frame, isDrawn(f) ? nextCleanFrame(*reader) : reader->next());
    if (!isDrawn(f)) continue;
    FOURDVT_TRY(fvvr->setFrame(frame.positions, frame.pictures));
    for (const PinholeCamera& camera : views_[f]) {
      FOURDVT_ASSIGN(auto picture, fvvr->renderStill(render::viewFromCamera(camera), {}));
      references_[f].push_back(std::move(picture));
    }
  }
  return {};
}

std::vector<LayerVariant> LayerStudy::variantsOf(int size) const {
  const bool large = size > 1024;
  std::vector<LayerVariant> out;
  for (const auto& [layers, labels] : joint_) out.push_back({kJoint, layers, labels.get(), true});
  if (!context_.options.quick && !large)
    for (int layers = 1; layers <= plan_.max_layers; ++layers) out.push_back({kNaive, layers, naive_.get(), false});
  return out;
}

// Labels for as many layers as the baker has; layers absent from the variant are empty.
Result<std::vector<uint8_t>> LayerStudy::labelsOf(const LayerVariant& variant, uint32_t frame) const {
  const bake::Job& own = variant.labels->job;
  FOURDVT_ASSIGN(auto labels, variant.labels->survey->labels(*own.capture.find(sequence_.name), frame));
  const size_t faces = own.mesh.decoded.topology.faceCount();
  labels.resize(faces * variant.layers);
  labels.resize(faces * plan_.max_layers, package::kNoCamera);
  return labels;
}

Status LayerStudy::addPictures(const std::vector<Image>& layers, Stored& stored) {
  FOURDVT_ASSIGN(const auto png, codedBytes(layers, encodePng));
  FOURDVT_ASSIGN(const auto jpeg, codedBytes(layers, [](const Image& layer) {
                   return platform::encodeImage(layer, ".jpg", kJpegQuality);
                 }));
  stored.png += png;
  stored.jpeg += jpeg;
  ++stored.pictures_of;
  return {};
}

Status LayerStudy::saveErrorMap(const LayerVariant& variant, int size, uint32_t frame, const Image& reference,
                                const Image& picture) {
  has_error_map_ = true;
  const double ssim = measure::scorePicture(reference, picture).ssim_fg;
  const std::string setting =
      variant.setting(size) + " frame=" + std::to_string(frame) + " score=" + std::to_string(ssim);
  return addPicture(context_, "error-map-" + std::to_string(size) + ".jpg", errorMap(reference, picture),
                    {"", sequence_.name, variant.method, setting, kPictureErrorMap, ssim, ""}, pictures_, 92);
}

Status LayerStudy::drawViews(const LayerVariant& variant, int size, uint32_t frame, const std::vector<Image>& layers) {
  FOURDVT_TRY(drawing_->show(layers));
  const auto& cameras = views_.at(frame);
  for (size_t v = 0; v < cameras.size(); ++v) {
    FOURDVT_ASSIGN(auto picture, drawing_->draw(cameras[v], variant.layers));
    const bool mapped = variant.method == kJoint && variant.layers == std::min(kErrorMapLayers, plan_.max_layers);
    if (mapped && v == 1 && !has_error_map_)
      FOURDVT_TRY(saveErrorMap(variant, size, frame, references_.at(frame)[v], picture));
    lane_.add(references_.at(frame)[v], std::move(picture), keyOf(variant));
  }
  return {};
}

Status LayerStudy::addFrame(const LayerVariant& variant, int size, uint32_t frame, std::vector<Image> layers) {
  Stored& stored = shown_[keyOf(variant)].stored;
  if (variant.stored && frame < plan_.video_frames) {
    auto& queue = gop_[keyOf(variant)];
    queue.resize(layers.size());
    for (size_t l = 0; l < layers.size(); ++l) {
      queue[l].emplace_back(size, size);
      fillI420(layers[l], queue[l].back());
    }
  }
  if (!isDrawn(frame)) return {};
  if (variant.stored) FOURDVT_TRY(addPictures(layers, stored));
  return drawViews(variant, size, frame, layers);
}

Status LayerStudy::encodeGop(const std::vector<LayerVariant>& variants, int size) {
  struct Stream {
    Stored* stored;
    const std::vector<encode::I420Picture>* pictures;
  };
  std::vector<Stream> streams;
  for (const LayerVariant& variant : variants)
    if (auto queue = gop_.find(keyOf(variant)); queue != gop_.end())
      for (const auto& pictures : queue->second) streams.push_back({&shown_[keyOf(variant)].stored, &pictures});
  const auto encode = [&](const Stream& stream) -> Result<uint64_t> {
    FOURDVT_ASSIGN(auto encoder, encode::GopEncoder::create(
                                     {.width = size, .height = size, .fps = context_.capture->fps, .crf = kStudyCrf}));
    for (const encode::I420Picture& picture : *stream.pictures) {
      FOURDVT_TRY(checkStop(context_));
      FOURDVT_TRY(encoder->push(picture.view()));
    }
    FOURDVT_ASSIGN(auto gop, encoder->finish());
    return gopBytes(gop);
  };
  for (size_t i = 0; i < streams.size(); i += 2) {
    std::future<Result<uint64_t>> second;
    if (i + 1 < streams.size()) second = std::async(std::launch::async, encode, streams[i + 1]);
    auto bytes = encode(streams[i]);
    auto more = second.valid() ? second.get() : Result<uint64_t>(0);
    if (!bytes) return bytes.error();
    if (!more) return more.error();
    streams[i].stored->video += bytes.value();
    if (i + 1 < streams.size()) streams[i + 1].stored->video += more.value();
  }
  gop_.clear();
  return {};
}

Result<Rows> LayerStudy::measureSize(int size, double before, double share) {
  shown_.clear();
  pictures_.clear();
  has_error_map_ = false;
  const std::vector<LayerVariant> variants = variantsOf(size);
  const bake::Job& plan = job();
  bake::FrameBakerOptions options;
  options.layer_sizes.assign(plan_.max_layers, size);
  options.gutter_texels =
      std::max(2.0f, static_cast<float>(bake::BakeOptions().gutter_texels * size) / bake::BakeOptions().texture);
  options.colour_maps = naive_->survey->colourMaps();
  FOURDVT_ASSIGN(auto baker, makeBaker(context_, plan, options));
  FOURDVT_ASSIGN(drawing_, LayerDrawing::create(*context_.device, plan, size, plan_.max_layers));
  for (const LayerVariant& variant : variants) {
    FOURDVT_ASSIGN(auto bytes, drawing_->gpuBytes(variant.layers));
    shown_[keyOf(variant)].gpu_bytes = static_cast<double>(bytes);
  }
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(*context_.capture, sequence_, context_.open_video));
  const std::vector<uint32_t> gops = encode::planGops(sequence_.frame_count, kStudyGop);
  const uint32_t frames = std::max(plan_.video_frames, views_.empty() ? 0 : views_.rbegin()->first + 1);
  for (uint32_t f = 0; f < frames; ++f) {
    FOURDVT_TRY(checkStop(context_));
    if (f > 0 && std::find(gops.begin(), gops.end(), f) != gops.end()) FOURDVT_TRY(encodeGop(variants, size));
    FOURDVT_ASSIGN(auto frame, reader->next());
    if (!isDrawn(f) && f >= plan_.video_frames) continue;
    setBakerFrame(*baker, plan, frame);
    const Positions positions = bake::reordered(plan.mesh, frame.positions);
    for (const LayerVariant& variant : variants) {
      if (!isDrawn(f) && (!variant.stored || f >= plan_.video_frames)) continue;
      FOURDVT_ASSIGN(auto labels, labelsOf(variant, f));
      FOURDVT_ASSIGN(auto layers, baker->resample(labels));
      layers.resize(variant.layers);
      baker->fill(layers);
      labels.resize(plan.mesh.decoded.topology.faceCount() * variant.layers);
      if (isDrawn(f)) FOURDVT_TRY(drawing_->setGeometry(positions, labels, variant.layers));
      FOURDVT_TRY(addFrame(variant, size, f, std::move(layers)));
    }
    reportProgress(context_, name_,
                   std::to_string(size) + " texels " + std::to_string(f + 1) + "/" + std::to_string(frames),
                   before + share * (f + 1) / frames);
  }
  FOURDVT_TRY(encodeGop(variants, size));
  for (const auto& [key, score] : lane_.finish()) shown_[key].scores.add(score);
  drawing_.reset();
  Rows out;
  for (const LayerVariant& variant : variants) {
    const Shown& shown = shown_[keyOf(variant)];
    const RowWriter row(out, kLayers, sequence_.name, variant.method, variant.setting(size));
    const Stored& stored = shown.stored;
    if (plan_.frames > 0) {
      writeScores(row, shown.scores);
      row.add({{kGpuBytes, shown.gpu_bytes}});
    }
    if (stored.pictures_of > 0) {
      row.add({{kImageBytes, static_cast<double>(stored.png) / stored.pictures_of},
               {"jpeg_bytes_frame", static_cast<double>(stored.jpeg) / stored.pictures_of}});
    }
    if (!variant.stored || plan_.video_frames == 0) continue;
    const double a_frame = static_cast<double>(stored.video) / plan_.video_frames;
    row.add({{kVideoBytes, a_frame * sequence_.frame_count}, {kVideoBps, 8 * a_frame * context_.capture->fps}});
  }
  out.insert(out.end(), pictures_.begin(), pictures_.end());
  return out;
}

Result<Rows> LayerStudy::run() {
  FOURDVT_TRY(survey());
  if (plan_.frames > 0) FOURDVT_TRY(drawReferences());
  double total = 0, before = 0.15;
  for (int size : plan_.sizes) total += std::pow(size, 1.5);
  Rows out;
  for (int size : plan_.sizes) {
    const double share = 0.85 * std::pow(size, 1.5) / total;
    FOURDVT_TRY(addPart(
        context_, name_ + "-" + std::to_string(size), [&] { return measureSize(size, before, share); }, out));
    before += share;
  }
  return out;
}

}  // namespace

Result<Rows> runLayers(const StudyContext& context) { return LayerStudy(context, LayerOutput::Drawn).run(); }
Result<Rows> runLayerVideos(const StudyContext& context) { return LayerStudy(context, LayerOutput::Encoded).run(); }

}  // namespace fourdvt::study
