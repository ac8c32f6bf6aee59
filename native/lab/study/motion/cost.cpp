// SPDX-License-Identifier: Apache-2.0
// Milliseconds of drawing a blend of two members, by alignment, in interleaved runs; and the number of characters with
// baked alignment per character with run-time flow at equal time.

#include "base/robust.h"
#include "base/watch.h"
#include "lab/study/motion/motion.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr int kSizes[][2] = {{512, 512}, {720, 960}};
constexpr int kWarmUpDraws = 1;

struct AlignVariant {
  AlignMethod method;
  int characters = 1;
  std::vector<double> times_ms;
};

Status drawOnce(const MotionSubject& subject, const render::View& view, AlignVariant& variant, gpu::TargetId target,
                bool counts) {
  const Watch watch;
  FOURDVT_TRY(subject.stage.drawMany(view, variant.characters, variant.method, target));
  uint8_t pixel[4];  // reading it waits for all drawing
  FOURDVT_TRY(subject.context.device->readPixels(
      target, gpu::PixelFormat::RGBA8, {.x = view.width / 2, .y = view.height / 2, .width = 1, .height = 1}, pixel));
  const double time_ms = watch.ms();
  if (counts) variant.times_ms.push_back(time_ms);
  return {};
}

Status race(const MotionSubject& subject, int width, int height, int frames, std::vector<AlignVariant>& variants) {
  gpu::Device& device = *subject.context.device;
  const render::View view = render::viewFromCamera(subject.stage.orbit(kFirstAzimuth_deg, width, height));
  FOURDVT_ASSIGN(auto color, gpu::makeTexture(device, {.width = width, .height = height, .label = "motion cost"}));
  FOURDVT_ASSIGN(auto target, gpu::makeTarget(device, {.colors = {color.id()}, .label = "motion cost"}));
  for (int i = -kWarmUpDraws; i < frames; ++i) {
    FOURDVT_TRY(checkStop(subject.context));
    for (AlignVariant& variant : variants) FOURDVT_TRY(drawOnce(subject, view, variant, target.id(), i >= 0));
  }
  return {};
}

// Number of characters drawn in `limit_ms`: interpolated between the counts measured, extrapolated from the last two
// beyond them. `times`: ascending.
double charactersWithin(const std::vector<std::pair<int, double>>& times, double limit_ms) {
  size_t i = 1;
  while (i + 1 < times.size() && times[i].second < limit_ms) ++i;
  const auto [n0, t0] = times[i - 1];
  const auto [n1, t1] = times[i];
  return t1 > t0 ? n0 + (limit_ms - t0) / (t1 - t0) * (n1 - n0) : n0;
}

}  // namespace

Result<Rows> measureCost(const MotionSubject& subject) {
  FOURDVT_TRY(subject.stage.show(subject.motion().frame_count / 3));
  Rows out;
  const int frames = subject.quick() ? 3 : 15;
  for (const auto [width, height] : kSizes) {
    if (subject.quick() && width != kSizes[0][0]) break;
    std::vector<AlignVariant> variants;
    for (const AlignMethod& method : subject.methods({kAlignNone, kAlignBaked, kFlowGpu, kFlowDis, kFlowOpencv}))
      variants.push_back({method, 1, {}});
    const size_t singles = variants.size();
    if (subject.stage.aligned())
      for (const int characters : {3, 6, 12}) {
        if (subject.quick() && characters != 6) continue;
        variants.push_back({kAlignBaked, characters, {}});
      }
    FOURDVT_TRY(race(subject, width, height, frames, variants));
    const double none = median(variants[0].times_ms);
    std::vector<std::pair<int, double>> baked;
    double flow = 0;
    for (size_t i = 0; i < variants.size(); ++i) {
      const double ms = median(variants[i].times_ms);
      const std::string size = "size=" + std::to_string(width) + "x" + std::to_string(height);
      const RowWriter row(out, kMotionCost, subject.motion().name, variants[i].method,
                          i < singles ? size : size + " characters=" + std::to_string(variants[i].characters));
      row.add({{kFrameMs, ms}});
      if (i < singles) row.add({{kRatioToNone, ms / none}});
      if (variants[i].method == kAlignBaked) baked.emplace_back(variants[i].characters, ms);
      if (variants[i].method == kFlowGpu) flow = ms;
    }
    if (baked.size() > 1)
      RowWriter(out, kMotionCost, subject.motion().name, kAlignBaked,
                "size=" + std::to_string(width) + "x" + std::to_string(height))
          .add({{kCharactersPerFlow, charactersWithin(baked, flow)}});
  }
  return out;
}

}  // namespace fourdvt::study
