// SPDX-License-Identifier: Apache-2.0
// Frame rate of the layered character against FVVR (Volino and Hilton 2013, 4.4), with the passes of a frame and the
// textures held.
#include <filesystem>

#include "bake/bake.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/frame_rate.h"
#include "lab/study/steps/steps.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr int kSpeedFrames = 24, kQuickSpeedFrames = 10;

// Bakes one sequence with default settings.
Result<std::string> bakeOwn(const StudyContext& context) {
  bake::BakeOptions options = defaultBake(context, context.work() + "/speed");
  options.sequences = {context.options.sequences.empty() ? context.capture->sequences.front().name
                                                         : context.options.sequences.front()};
  FOURDVT_TRY(bakeOnce(context, options, [&](const std::string& stage, double share) {
    reportProgress(context, "speed", "bake " + stage, 0.5 * share);
  }));
  return options.character_folder;
}

std::string sizeText(const FrameRate& rate) { return std::to_string(rate.width) + "x" + std::to_string(rate.height); }

// Rows of one renderer at one picture size.
struct SpeedRows {
  Rows& out;
  const FrameRates& rates;
  std::string method, setting;

  RowWriter writer() const { return {out, kSpeed, rates.sequence, method, setting}; }
  void addTimes(const PassTimes& times, uint64_t gpu_bytes) const {
    writer().add({{kFramesPerS, times.framesPerSecond()},
                  {kFrameMs, times.frame_ms},
                  {kGpuBytes, static_cast<double>(gpu_bytes)}});
  }
  void addPasses(const PassTimes& times, const std::string& size) const {
    for (const auto& [name, ms] : {std::pair{"upload", times.upload_ms},
                                   {"geometry", times.geometry_ms},
                                   {"depth maps", times.depth_maps_ms},
                                   {"shading", times.shading_ms},
                                   {"readback", times.readback_ms}})
      if (method == kFvvr || std::string(name) != "depth maps")
        RowWriter(out, kSpeed, rates.sequence, method, setting + " pass=" + size + " " + name).add({{kFrameMs, ms}});
  }
};

// Setting suffix " closest=M"; empty for all cameras.
std::string closestSetting(const FvvrRate& fvvr) {
  return fvvr.closest ? " closest=" + std::to_string(fvvr.closest) : "";
}

void addSize(Rows& out, const FrameRates& rates, const FrameRate& rate, bool with_passes) {
  const std::string setting = "layers=" + std::to_string(rates.layers) + " size=" + std::to_string(rates.layer_side) +
                              " view=" + sizeText(rate);
  const SpeedRows ours{out, rates, kMethodLayered, setting};
  ours.addTimes(rate.layered, rates.layered_bytes);
  if (with_passes) ours.addPasses(rate.layered, sizeText(rate));
  for (const FvvrRate& fvvr : rate.fvvr) {
    const SpeedRows theirs{out, rates, kFvvr, setting + closestSetting(fvvr)};
    theirs.addTimes(fvvr.times, rates.fvvr_bytes);
    if (with_passes) theirs.addPasses(fvvr.times, sizeText(rate));
    const RowWriter ratios = SpeedRows{out, rates, kMethodLayered, theirs.setting}.writer();
    ratios.add({{kRatioToFvvr, rate.ratio(fvvr.times)},
                {kDrawRatioToFvvr, rate.drawRatio(fvvr.times)},
                {"shading_ratio_to_fvvr", rate.shadingRatio(fvvr.times)}});  // excluding depth maps
  }
}

}  // namespace

Result<Rows> runSpeed(const StudyContext& context) {
  std::vector<std::string> characters;
  const std::string as_baked = context.work() + "/methods/" + kJointDefault,
                    papers_size = context.work() + "/methods/joint-512";
  if (isCharacter(as_baked)) {
    characters.push_back(as_baked);
  } else {
    FOURDVT_ASSIGN(auto own, bakeOwn(context));
    characters.push_back(std::move(own));
  }
  if (!context.options.quick && isCharacter(papers_size)) characters.push_back(papers_size);
  FrameRateOptions options;
  options.frames = context.options.quick ? kQuickSpeedFrames : kSpeedFrames;
  options.stop = context.stop;
  Rows out;
  for (size_t i = 0; i < characters.size(); ++i) {
    reportProgress(context, "speed", std::filesystem::path(characters[i]).filename().string(),
                   0.5 + 0.5 * double(i) / characters.size());
    FOURDVT_ASSIGN(auto rates,
                   measureFrameRates(*context.device, *context.capture, context.open_video, characters[i], options));
    for (const FrameRate& rate : rates.sizes) addSize(out, rates, rate, i == 0);
  }
  return out;
}

}  // namespace fourdvt::study
