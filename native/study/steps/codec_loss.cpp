// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "bake/texels/fill.h"
#include "study/run/figures.h"
#include "study/run/run_steps.h"
#include "study/run/scene.h"
#include "study/steps/codec.h"
#include "study/steps/methods.h"

namespace fourdvt::study {
namespace {

constexpr uint32_t kCodecEvery = 4;

class CodecLoss {
 public:
  CodecLoss(const StudyContext& context, const capture::CaptureSequence& sequence)
      : context_(context), sequence_(sequence) {}
  Result<Figures> run(const std::vector<Method>& methods);

 private:
  struct Lane {
    const Method* method = nullptr;
    std::unique_ptr<SurveyedJob> job;
    std::unique_ptr<VideoSource> video;
    bake::FrameBaker* baker = nullptr;
    SquaredError error;
  };
  Status open(const Method& method);
  Status compare(Lane& lane, uint32_t frame);
  Result<std::vector<Image>> layersOf(Lane& lane, uint32_t frame);
  const std::vector<uint8_t>& charts(const bake::Job& job, int size);

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  std::vector<Lane> lanes_;
  std::map<std::vector<int>, std::unique_ptr<bake::FrameBaker>> bakers_;  // by layer sizes
  std::map<int, std::vector<uint8_t>> charts_;
};

Status CodecLoss::open(const Method& method) {
  Lane lane;
  lane.method = &method;
  FOURDVT_ASSIGN(lane.job, surveyOnly(context_, method.options));
  const std::string path = method.options.character_folder + "/" + sequence_.name + ".mp4";
  FOURDVT_ASSIGN(lane.video, context_.open_video(path, 3));
  const bake::FrameBakerOptions options = bakerOptions(*lane.job);
  auto& baker = bakers_[options.layer_sizes];
  if (!baker) {
    FOURDVT_ASSIGN(baker, makeBaker(context_, lane.job->job, options));
  }
  lane.baker = baker.get();
  lanes_.push_back(std::move(lane));
  return {};
}

const std::vector<uint8_t>& CodecLoss::charts(const bake::Job& job, int size) {
  auto& inside = charts_[size];
  if (inside.empty()) inside = bake::makeGutterMap(job.mesh.decoded.topology, size, 1).inside;
  return inside;
}

Result<std::vector<Image>> CodecLoss::layersOf(Lane& lane, uint32_t frame) {
  const capture::CaptureSequence& captured = *lane.job->job.capture.find(sequence_.name);
  const bool per_texel = lane.method->options.labels == bake::LabelMode::PerTexel;
  FOURDVT_ASSIGN(auto labels, per_texel ? lane.job->survey->penaltyOrder(captured, frame)
                                        : lane.job->survey->labels(captured, frame));
  FOURDVT_ASSIGN(auto layers, per_texel ? lane.baker->resamplePerTexel(labels) : lane.baker->resample(labels));
  lane.baker->fill(layers);
  return layers;
}

Status CodecLoss::compare(Lane& lane, uint32_t frame) {
  FOURDVT_ASSIGN(auto decoded, lane.video->next());
  if (!decoded)
    return Error{ErrorId::VideoTooShort, lane.method->options.character_folder + ": " + sequence_.name +
                                             ".mp4 ends early; delete the report folder and run the study again"};
  if (frame % kCodecEvery) return {};
  FOURDVT_ASSIGN(auto layers, layersOf(lane, frame));
  const Image& picture = *decoded;
  const auto& rects = lane.job->job.layout.layers;
  for (size_t l = 0; l < rects.size(); ++l) {
    Image part(rects[l].width, rects[l].height, 3);
    for (int y = 0; y < part.height; ++y)
      std::copy_n(picture.at(rects[l].x, rects[l].y + y), size_t(3) * part.width, part.at(0, y));
    lane.error.add(layers[l], part, charts(lane.job->job, part.width));
  }
  return {};
}

Result<Figures> CodecLoss::run(const std::vector<Method>& methods) {
  for (const Method& method : methods) FOURDVT_TRY(open(method));
  FOURDVT_ASSIGN(auto reader, capture::FrameReader::open(*context_.capture, sequence_, context_.open_video));
  const uint32_t last = (sequence_.frame_count - 1) / kCodecEvery * kCodecEvery;
  for (uint32_t f = 0; f <= last; ++f) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto frame, reader->next());
    if (f % kCodecEvery == 0)
      for (auto& [sizes, baker] : bakers_) setBakerFrame(*baker, lanes_[0].job->job, frame);
    for (Lane& lane : lanes_) FOURDVT_TRY(compare(lane, f));
  }
  Figures out;
  for (const Lane& lane : lanes_)
    RowWriter(out, "codec-loss", sequence_.name, lane.method->name, lane.method->setting())
        .add("psnr_layers_db", lane.error.psnr_db(), "dB");
  return out;
}

}  // namespace

Result<Figures> measureCodecLoss(const StudyContext& context, const capture::CaptureSequence& sequence,
                                 const std::vector<Method>& methods) {
  return CodecLoss(context, sequence).run(methods);
}

}  // namespace fourdvt::study
