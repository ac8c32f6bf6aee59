// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "bake/texels/fill.h"
#include "study/figures.h"
#include "study/run_steps.h"
#include "study/scene.h"
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
  auto job = surveyOnly(context_, method.options);
  if (!job) return job.error();
  lane.job = job.take();
  const std::string path = method.options.character_folder + "/" + sequence_.name + ".mp4";
  auto video = context_.open_video(path, 3);
  if (!video) return video.error();
  lane.video = video.take();
  const bake::Job& plan = lane.job->job;
  bake::FrameBakerOptions options;
  for (const package::Rect& rect : plan.layout.layers) options.layer_sizes.push_back(rect.width);
  options.gutter_texels = static_cast<float>(method.options.gutter_texels);
  options.resample = method.options.resample;
  options.colour_maps = lane.job->survey->colourMaps();
  auto& baker = bakers_[options.layer_sizes];
  if (!baker) {
    auto made = bake::FrameBaker::create(*context_.device, plan.cameras, plan.mesh.decoded.topology,
                                         plan.mesh.decoded.positions, options);
    if (!made) return made.error();
    baker = made.take();
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
  auto labels = per_texel ? lane.job->survey->penaltyOrder(captured, frame) : lane.job->survey->labels(captured, frame);
  if (!labels) return labels.error();
  auto layers = per_texel ? lane.baker->resamplePerTexel(labels.value()) : lane.baker->resample(labels.value());
  if (!layers) return layers;
  lane.baker->fill(layers.value());
  return layers;
}

Status CodecLoss::compare(Lane& lane, uint32_t frame) {
  auto decoded = lane.video->next();
  if (!decoded) return decoded.error();
  if (!decoded.value())
    return Error{ErrorId::VideoTooShort, lane.method->options.character_folder + ": " + sequence_.name +
                                             ".mp4 ends early; delete the report folder and run the study again"};
  if (frame % kCodecEvery) return {};
  auto layers = layersOf(lane, frame);
  if (!layers) return layers.error();
  const Image& picture = *decoded.value();
  const auto& rects = lane.job->job.layout.layers;
  for (size_t l = 0; l < rects.size(); ++l) {
    Image part(rects[l].width, rects[l].height, 3);
    for (int y = 0; y < part.height; ++y)
      std::copy_n(picture.at(rects[l].x, rects[l].y + y), size_t(3) * part.width, part.at(0, y));
    lane.error.add(layers.value()[l], part, charts(lane.job->job, part.width));
  }
  return {};
}

Result<Figures> CodecLoss::run(const std::vector<Method>& methods) {
  for (const Method& method : methods) FOURDVT_TRY(open(method));
  auto reader = capture::FrameReader::open(*context_.capture, sequence_, context_.open_video);
  if (!reader) return reader.error();
  const uint32_t last = (sequence_.frame_count - 1) / kCodecEvery * kCodecEvery;
  for (uint32_t f = 0; f <= last; ++f) {
    FOURDVT_TRY(checkStop(context_));
    auto frame = reader.value()->next();
    if (!frame) return frame.error();
    if (f % kCodecEvery == 0)
      for (auto& [sizes, baker] : bakers_) setBakerFrame(*baker, lanes_[0].job->job, frame.value());
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
