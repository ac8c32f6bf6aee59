// SPDX-License-Identifier: Apache-2.0
// Rate-distortion, in two steps: "rate" measures the default codec for one, two and three layers, "codecs" codecs,
// presets, layouts and sizes of layers. Layers are baked once per size and layout; each point then encodes, decodes and
// renders the same pictures (rate_point.h).
#include <filesystem>

#include "bake/quality.h"
#include "bake/run/character_files.h"
#include "bake/texels/frame_baker.h"
#include "base/text.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/rate_point.h"
#include "lab/study/steps/steps.h"
#include "mattes/frame_reader.h"

namespace fourdvt::study {
namespace {

struct LayerSetting {
  int texture, layers;
  bool equal;
};

struct CodecSetting {
  encode::Codec codec;
  const char* preset;
  std::vector<int> crfs;
};

struct Group {
  LayerSetting layers;
  std::vector<CodecSetting> codecs;
  // True if the step "rate" covers a group of the same layers, including its points without a codec and at the default
  // setting.
  bool again = false;
};

constexpr uint32_t kQuickClipFrames = 9;
constexpr int kFallbackCameras = 3;  // views if there are no held-out cameras

using encode::Codec;

// Groups of L = 1, 2, 3 layers over the same bitrates: fewer layers need fewer bits, and cover them at a lower rate
// factor.
std::vector<Group> layerGroups(bool quick) {
  const std::vector<CodecSetting> few{{Codec::H264, "veryfast", {26, 34}}, {Codec::Av1, "7", {46}}};
  if (quick) return {{{512, 3, false}, few}, {{512, 1, false}, {{Codec::H264, "veryfast", {20, 26, 34}}}}};
  return {{{1024, 3, false}, {{Codec::H264, "medium", {20, 24, 28, 32, 36}}}},
          {{1024, 2, false}, {{Codec::H264, "medium", {16, 20, 24, 28, 32, 36}}}},
          {{1024, 1, false}, {{Codec::H264, "medium", {14, 18, 22, 26, 30, 34}}}}};
}

std::vector<Group> codecGroups() {
  const std::vector<CodecSetting> others{{Codec::H264, "veryfast", {24, 28, 32, 36}},
                                         {Codec::H264, "slower", {20, 24, 29, 32, 36}},
                                         {Codec::Vp9, "3", {34, 40, 46, 52}},
                                         {Codec::Av1, "6", {34, 40, 46, 52}}};
  const std::vector<CodecSetting> some{{Codec::H264, "medium", {24, 30, 36}}, {Codec::Av1, "6", {40, 50}}};
  return {{{1024, 3, false}, others, true},
          {{1024, 3, true}, some},
          {{1024, 2, false}, {{Codec::Av1, "6", {40, 50}}}, true},
          {{512, 3, false}, some},
          {{512, 3, true}, some},
          {{1536, 3, false}, some},
          {{2048, 2, false}, some},
          {{2048, 3, false}, some}};
}

std::string settingOf(const LayerSetting& l) {
  return printed("size=%d layers=%d layout=%s", l.texture, l.layers, l.equal ? "equal" : "default");
}

// Deletes the large pictures when the group is done.
struct PicturesFile {
  std::string path;
  ~PicturesFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

class RateStudy {
 public:
  // `name`: step name.
  RateStudy(const StudyContext& context, std::string name)
      : context_(context), sequence_(shortestSequence(context)), name_(std::move(name)) {}
  Result<Rows> run(const std::vector<Group>& groups);

 private:
  Status measureGroup(const Group& group);
  Status bakeLayers(SurveyedJob& surveyed, RateClip& clip) const;
  Result<std::vector<RateView>> makeViews(uint32_t frame_count) const;
  Status measurePoint(RateMeter& meter, const LayerSetting& layers, const encode::EncodeSettings& encode, bool chosen,
                      const std::vector<RateView>& views);
  void write(const std::string& method, const std::string& setting, const RateScore& score);
  void tell(const std::string& detail) const;

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  const std::string name_;
  size_t points_ = 0, done_ = 0;
  Rows rows_;
};

void RateStudy::tell(const std::string& detail) const {
  reportProgress(context_, name_, detail, points_ ? double(done_) / double(points_) : 0);
}

// Writes the pictures to clip.pictures_path; returns geometry and labels of each frame.
Status RateStudy::bakeLayers(SurveyedJob& surveyed, RateClip& clip) const {
  const bake::Job& job = surveyed.job;
  FOURDVT_ASSIGN(auto baker, makeBaker(context_, job, bakerOptions(surveyed)));
  FOURDVT_ASSIGN(auto reader,
                 mattes::FrameReader::open(job.capture, *job.capture.find(sequence_.name), context_.open_video));
  encode::I420Picture picture(job.layout.width, job.layout.height);
  for (uint32_t f = 0; f < clip.frame_count; ++f) {
    FOURDVT_TRY(checkStop(context_));
    tell("layers of " + std::to_string(job.options.texture) + ", frame " + std::to_string(f + 1));
    FOURDVT_ASSIGN(auto frame, reader->next());
    setBakerFrame(*baker, job, frame);
    FOURDVT_ASSIGN(auto labels, surveyed.survey->labels(*job.capture.find(sequence_.name), f));
    FOURDVT_ASSIGN(auto layers, baker->resample(labels));
    baker->fill(layers);
    encode::tileFrame(job.layout, layers, f, picture);
    FOURDVT_TRY(appendPicture(clip.pictures_path, picture, f == 0));
    clip.positions.push_back(bake::reordered(job.mesh, frame.positions));
    clip.labels.push_back(std::move(labels));
  }
  return {};
}

// Views at held-out cameras and frames; without them, three cameras of the ring without a truth.
Result<std::vector<RateView>> RateStudy::makeViews(uint32_t frame_count) const {
  std::vector<RateView> views;
  FOURDVT_ASSIGN(auto held_out, heldOutCameras(context_));
  for (const uint32_t frame : sequence_.test_frames) {
    for (const PinholeCamera& camera : held_out) {
      if (frame >= frame_count) continue;
      FOURDVT_ASSIGN(auto truth, measure::heldOutTruth(sequence_, camera, frame));
      views.push_back({frame, camera, std::move(truth), {}});
    }
  }
  if (!views.empty()) return views;
  const std::vector<PinholeCamera> ring = captureCameras(context_);
  for (const uint32_t frame : {0u, frame_count / 2})
    for (int k = 0; k < kFallbackCameras; ++k)
      views.push_back({frame, ring[ring.size() * size_t(k) / kFallbackCameras], {}, {}});
  return views;
}

void RateStudy::write(const std::string& method, const std::string& setting, const RateScore& score) {
  const RowWriter out(rows_, rows::kRate, sequence_.name, method, setting);
  if (score.video_bps > 0) {
    out.add({{rows::kVideoBps, score.video_bps},
             {rows::kEncodeMsFrame, score.encode_ms_frame},
             {"unreadable_barcodes", score.unreadable_barcodes},
             {"ssim_fg_vs_uncompressed", score.uncompressed.mean().ssim_fg},
             {"psnr_fg_vs_uncompressed_db", score.uncompressed.mean().psnr_fg_db}});
  }
  if (score.truth.count() > 0)
    out.add({{rows::kSsimFg, score.truth.mean().ssim_fg}, {rows::kPsnrFgDb, score.truth.mean().psnr_fg_db}});
}

Status RateStudy::measurePoint(RateMeter& meter, const LayerSetting& layers, const encode::EncodeSettings& encode,
                               bool chosen, const std::vector<RateView>& views) {
  FOURDVT_TRY(checkStop(context_));
  const std::string setting = (chosen ? "chosen=1 preset=" : "preset=") + encode.preset +
                              " crf=" + std::to_string(encode.crf) + " " + settingOf(layers);
  tell(std::string(encode::infoOf(encode.codec).name) + " " + setting);
  FOURDVT_ASSIGN(auto score, meter.measure(encode, views));
  write(encode::infoOf(encode.codec).name, setting, score);
  ++done_;
  return {};
}

Status RateStudy::measureGroup(const Group& group) {
  bake::BakeOptions options = studyBake(context_, "rate");
  options.sequences = {sequence_.name};
  options.texture = group.layers.texture;
  options.layers = group.layers.layers;
  options.equal_layers = group.layers.equal;
  FOURDVT_ASSIGN(auto surveyed, surveyOnly(context_, options));
  const bake::Job& job = surveyed->job;
  RateClip clip;
  const PicturesFile pictures{context_.work() + "/rate_pictures.yuv"};
  clip.layout = job.layout;
  clip.fps = job.capture.fps;
  clip.frame_count = context_.options.quick ? std::min(kQuickClipFrames, sequence_.frame_count) : sequence_.frame_count;
  clip.pictures_path = pictures.path;
  clip.gop_first_frames = encode::planGops(clip.frame_count, bake::BakeOptions().gop);
  clip.character = bake::describeCharacter(job);
  clip.mesh = &job.mesh.decoded;
  FOURDVT_TRY(bakeLayers(*surveyed, clip));
  FOURDVT_ASSIGN(auto views, makeViews(clip.frame_count));
  FOURDVT_ASSIGN(auto meter, RateMeter::create(*context_.device, clip));
  FOURDVT_TRY(meter->drawUncompressed(views));
  if (!group.again) write("uncompressed", settingOf(group.layers), meter->scoreUncompressed(views));
  for (const CodecSetting& codec : group.codecs) {
    encode::EncodeSettings encode;
    encode.codec = codec.codec;
    encode.preset = codec.preset;
    for (const int crf : codec.crfs) {
      encode.crf = crf;
      FOURDVT_TRY(measurePoint(*meter, group.layers, encode, false, views));
    }
  }
  const bake::BakeOptions chosen;  // the default
  if (group.again || chosen.texture != options.texture || chosen.layers != options.layers ||
      chosen.equal_layers != options.equal_layers)
    return {};
  encode::EncodeSettings encode;
  encode.codec = chosen.codec;
  encode.crf = chosen.crf;
  encode.preset = chosen.preset.empty() ? encode::infoOf(chosen.codec).default_preset : chosen.preset;
  return measurePoint(*meter, group.layers, encode, true, views);
}

Result<Rows> RateStudy::run(const std::vector<Group>& groups) {
  for (const Group& group : groups)
    for (const CodecSetting& codec : group.codecs) points_ += codec.crfs.size();
  Rows all;
  for (const Group& group : groups) {
    const std::string name = name_ + "-" + std::to_string(group.layers.texture) + "-" +
                             std::to_string(group.layers.layers) + (group.layers.equal ? "-equal" : "");
    const auto measure = [&]() -> Result<Rows> {
      rows_.clear();
      FOURDVT_TRY(measureGroup(group));
      return std::move(rows_);
    };
    FOURDVT_TRY(addPart(context_, name, measure, all));
  }
  return all;
}

}  // namespace

Result<Rows> runRate(const StudyContext& context) {
  return RateStudy(context, "rate").run(layerGroups(context.options.quick));
}
Result<Rows> runCodecs(const StudyContext& context) {
  return RateStudy(context, "codecs").run(context.options.quick ? std::vector<Group>() : codecGroups());
}

}  // namespace fourdvt::study
